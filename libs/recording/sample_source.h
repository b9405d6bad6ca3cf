#pragma once

#include <filesystem>
#include <optional>

#include "recording/rawlog.h"

namespace fathom {

/// Where samples come from, in the order in which they arrive: a recording, a simulation, a mix of both, and
/// any of these with something done to it on the way.
class SampleSource {
 public:
  virtual ~SampleSource() = default;

  virtual const RecordingHeader& header() const = 0;
  /// The next sample, or nothing at the end. File names of images are absolute or relative to imageFolder().
  /// Throws as RawlogReader::next().
  virtual std::optional<Sample> next() = 0;
  virtual std::filesystem::path imageFolder() const = 0;
  /// Share handed out so far, for progress.
  virtual double fraction() const = 0;
  /// What was lost to damage, once next() has returned nothing.
  virtual std::optional<RecordingLoss> loss() const { return std::nullopt; }
};

/// A rawlog as it is. Throws Error as RawlogReader.
class RecordingSource : public SampleSource {
 public:
  explicit RecordingSource(const std::filesystem::path& rawlog) : reader_(rawlog) {}

  const RecordingHeader& header() const override { return reader_.header(); }
  std::optional<Sample> next() override { return reader_.next(); }
  std::filesystem::path imageFolder() const override { return reader_.imageFolder(); }
  double fraction() const override { return reader_.fraction(); }
  std::optional<RecordingLoss> loss() const override { return reader_.loss(); }

 private:
  RawlogReader reader_;
};

}  // namespace fathom
