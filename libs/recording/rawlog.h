#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "recording/samples.h"

namespace fathom {

/// What was lost to truncation or damage.
struct RecordingLoss {
  std::uint64_t at_byte = 0;  ///< file offset where reading stopped: end of the last whole observation (for a
                              ///< gzip file, interpolated within the last 1 MiB of inflated data)
  std::uint64_t lost_bytes = 0;  ///< from there to the end of the file
  /// From the last entry read to the last one found behind the damage, or estimated; NaN where neither can be
  /// told, so where the file is cut off.
  double lost_seconds = 0.0;
  bool estimated = false;  ///< lost_seconds is lost_bytes over the bytes a second read so far
  bool cut_off = false;    ///< the file ends too early: nobody knows how much is lost
  std::string reason;      ///< one line
};

/// Progress of reading is told after so many entries.
inline constexpr std::uint64_t kEntriesPerProgress = 4096;

/// One line, without the file's name.
std::string describe(const RecordingLoss& loss);

/// Reads a rawlog (plain, gzip or Zstandard; observations only, or actions and frames) entry by entry: memory
/// does not depend on its length. MRPT takes each object apart, of whatever version it knows; what it may
/// allocate for one is limited, so damaged bytes cannot make it take gigabytes. What the recording convention
/// does not know, or MRPT cannot read since it is of a later one, is an UnknownSample.
///
/// Reading ends at the first damage. What a plain file cannot show is a changed digit within a number, and no
/// file a cut exactly between two entries (gzip: between two of RawlogWriter's blocks). Gzip data whose
/// checksum is wrong are not handed on where they come in blocks, as RawlogWriter writes them; in one long
/// stream the damage shows only at its end, and what was read since may be wrong.
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
  /// Throws Error (file, byte, reason) where an entry breaks the convention: a label on another class than
  /// its own, a DEPTH entry without pressure, an image in the rawlog itself.
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
/// and renamed by finish(); the same samples give the same bytes. The gzip data come in blocks (members) with
/// a checksum each, so that a reader can trust what lies before a damage. In the header comment, a line break
/// is stored as `\n` and a backslash as `\\`.
class RawlogWriter {
 public:
  /// `start` is the header's time. Throws Error where the file cannot be created.
  RawlogWriter(std::filesystem::path file, const RecordingHeader& header, Time start);
  ~RawlogWriter();  ///< without finish(): the part file is removed
  RawlogWriter(const RawlogWriter&) = delete;
  RawlogWriter& operator=(const RawlogWriter&) = delete;

  /// Samples must come in time order, with the convention's label for their kind (a PoseSample: any label
  /// that is not another kind's); a RecordingHeader and an UnknownSample cannot be written. Throws
  /// std::logic_error where that is not so, Error where the disk is full.
  void write(const Sample& sample);
  /// Throws Error where the disk is full or the rename fails.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fathom
