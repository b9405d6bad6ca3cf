#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "recording/samples.h"

namespace fathom {

/// What was lost at the end of a truncated or damaged rawlog.
struct RecordingLoss {
  std::uint64_t at_byte = 0;  ///< file offset where reading stopped: end of the last whole observation (for a
                              ///< gzip file, the offset in the compressed file, to the decompressor's buffer)
  std::uint64_t lost_bytes = 0;  ///< from there to the end of the file
  double lost_seconds = 0.0;     ///< estimated from the bytes a second read so far; see `estimated`
  std::string reason;            ///< one line
};

/// Reads a rawlog entry by entry: memory does not depend on its length.
/// Every object is checked for plausible lengths before MRPT decodes it, so damaged bytes cannot make it
/// allocate gigabytes or crash. Only the classes of the recording convention are decoded; other classes MRPT
/// knows are UnknownSample.
class RawlogReader {
 public:
  /// Throws Error where the file cannot be read or holds no whole observation.
  explicit RawlogReader(std::filesystem::path file);
  ~RawlogReader();
  RawlogReader(const RawlogReader&) = delete;
  RawlogReader& operator=(const RawlogReader&) = delete;

  const std::filesystem::path& file() const;
  /// The header comment, where the first entry is one; else all empty. Does not consume: next() returns it
  /// too.
  const RecordingHeader& header() const;
  /// The next entry, or nothing at the end. Never throws on damage: reading ends there and loss() says so.
  /// Throws Error where an entry breaks the convention (e.g. an INS entry of another class).
  std::optional<Sample> next();
  /// Set once next() has returned nothing because of damage or truncation.
  const std::optional<RecordingLoss>& loss() const;
  /// Share of the file's bytes read so far, for progress.
  double fraction() const;
  /// NAME_Images beside the rawlog.
  std::filesystem::path imageFolder() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a rawlog that stock MRPT 2.5.8 tools open: NAME.rawlog, gzip, "observations only". Written aside
/// and renamed by finish(); the same samples give the same bytes.
class RawlogWriter {
 public:
  RawlogWriter(std::filesystem::path file, const RecordingHeader& header, Time start);
  ~RawlogWriter();  ///< without finish(): the part file is removed
  RawlogWriter(const RawlogWriter&) = delete;
  RawlogWriter& operator=(const RawlogWriter&) = delete;

  /// Samples must come in time order (checked: throws std::logic_error).
  void write(const Sample& sample);
  /// Throws Error where the disk is full or the rename fails.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fathom
