#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "recording/samples.h"
#include "recording/tum.h"

namespace fathom {

/// One thing an importer established about a source that does not say it, by consistency between its streams.
struct Conclusion {
  std::string what;       ///< the question, e.g. "gyro axes"
  std::string concluded;  ///< the answer, and what the importer does about it
  std::string runner_up;  ///< the next best answer; empty for plain information
  /// How sure: residual of the runner-up over that of the best answer, multiplied over the axes compared.
  /// 1 is undecided; 0 for plain information.
  double residual_ratio = 0.0;
  std::string evidence;  ///< what was compared, with numbers and units
};

/// "what: concluded (N x better than runner-up); evidence", one line.
std::string toText(const Conclusion& conclusion);

/// "{x: …, …, roll_deg: …}", as vehicle files have a pose.
std::string yamlPose(const Pose& pose);

/// A vehicle file's camera as far as intrinsics and corners' sigma tell; the rest is generic. Without rate_hz
/// and pose.
std::string cameraLines(const CameraModel& camera, double corner_sigma_px = 0.15, int bits = 8);

/// Takes the samples of an import as they come, in time order.
using SampleSink = std::function<void(Sample&&)>;

/// A foreign recording in this program's convention.
struct ImportedRecording {
  RecordingHeader header;       ///< description only: file names are the caller's to choose
  Time start{};                 ///< of the first sample
  std::vector<Sample> samples;  ///< in time order
  /// The source's own navigation solution, T_odom_robot, if it has one. Never goes into the rawlog.
  std::vector<StampedPose> reference;
  std::string vehicle_yaml;  ///< text of a vehicle file, with comments that say where each number is from
  std::vector<Conclusion> conclusions;
  std::vector<std::string> remarks;  ///< what was left out or taken for absent, one line each
};

/// Where an import goes: FOLDER/NAME.rawlog and its companions.
struct ImportTarget {
  std::filesystem::path folder;
  std::string name;

  std::filesystem::path file(const std::string& ending) const { return folder / (name + ending); }
};

}  // namespace fathom
