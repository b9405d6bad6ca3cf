#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "audit/audit.h"
#include "estimation/batch_estimate.h"
#include "estimation/filter_start.h"

/// A recording on its way to the batch estimate: what `smooth` and `diagnose` have in common.
namespace fathom {

struct BatchRecordingOptions {
  std::filesystem::path rawlog;
  std::string vehicle, map;    ///< files; empty: those that the recording names
  std::string start = "auto";  ///< see startPose()
  bool pixels = false;         ///< take patches of the images too
  bool open_water = true;      ///< of them, what is above the horizon and beside the panels too
  /// Light is compared in so many moments at most, spread evenly over the recording: what each image has of
  /// its own makes the estimates' time grow with the third power of their number. Corners count in all.
  std::size_t most_lit = 100;
  AuditChoice audit{};           ///< what is wrong with the streams, and known to the user
  std::filesystem::path folder;  ///< of the results
};

/// A file that a result depends on.
struct InputFile {
  std::filesystem::path file;
  std::string fingerprint;  ///< of its content
};
/// Throws Error where it cannot be read.
InputFile inputFile(const std::filesystem::path& file);

/// The images of a recording, and the markers in them.
struct FoundMarkers {
  std::vector<ImageEntry> entries;
  Detections detections;
};

struct BatchRecording {
  BatchInput input;
  EffectParameters<double> calibration;  ///< effects known before
  FoundMarkers found;
  std::filesystem::path vehicle;
  std::optional<std::filesystem::path> map;
  std::vector<InputFile> files;  ///< rawlog, vehicle file, panel maps
  std::vector<std::string> remarks;
  /// Faults of its streams that audit() is sure of, and the user takes as they are.
  std::vector<std::string> accepted_faults{};
};

/// Detects the markers in all images, or takes the detections kept beside the recording. Throws Error, also
/// where a stream has a fault that audit() is sure of; Interrupted.
BatchRecording readBatchRecording(const BatchRecordingOptions& options,
                                  const EffectParameters<double>& calibration);

/// An estimate's path as a TUM file. Throws Error.
void writePath(const std::filesystem::path& file, const BatchData& data, const BatchEstimate& estimate);

/// "offset_m[1]".
std::string nameOfScalar(const EffectEstimate& estimate);

}  // namespace fathom
