#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "audit/audit.h"
#include "diagnosis/diagnosis.h"
#include "imaging/water.h"
#include "inputs/batch_recording.h"
#include "localization/localizer.h"
#include "recording/rawlog.h"
#include "simulation/simulate_recording.h"

/// The program's main jobs as calls, for programs of one's own: files in, results as values, what is left
/// open as the program has it. All throw Error where a file is not as it should be, in one line that says
/// which and where; Interrupted, where the program asked for that (core/progress.h).
namespace fathom {

/// What goes with a recording.
struct RecordingOptions {
  std::string vehicle, map;    ///< files; empty: those that the recording names
  std::string calibration;     ///< file of the effects that are known; empty: none are
  std::string start = "auto";  ///< see tasks/start_pose.h
  bool images = true;          ///< compare their pixels too, where there are images and a panel map
  AuditChoice audit{};         ///< what is wrong with the streams: accepted or corrected, by name
};

/// A recording ready to be diagnosed: its readings, the markers found in its images, patches of these.
/// Finding the markers takes the longest; they are kept beside the recording for the next time.
BatchRecording openRecording(const std::filesystem::path& rawlog, const RecordingOptions& options = {});

/// Which physics the recording shows that the models leave out, beyond what was known when it was opened.
Diagnosis diagnose(const BatchRecording& recording, DiagnosisOptions options = {});

struct LocalizedPath {
  LocalizationSummary summary;
  std::vector<Estimate> filtered;  ///< in time order, options.output_rate_hz
  std::vector<Estimate> smoothed;  ///< with options.smooth; in time order
  std::vector<Event> events;
  std::vector<std::string> remarks;   ///< what a user should know, one line each
  std::optional<RecordingLoss> loss;  ///< where the recording is damaged; a remark says so too
};
/// Where the robot was. The default options fuse INS and DVL; readTask() (tasks/task_spec.h) has others.
LocalizedPath localize(const std::filesystem::path& rawlog, const LocalizationOptions& options = {},
                       const RecordingOptions& recording = {});

/// What is simulated besides the vehicle on its path.
struct SimulatedDive {
  EffectParameters<double> effects;                  ///< physics that the sensor models leave out
  std::optional<std::filesystem::path> panel_map{};  ///< with it, water and a camera there are images
  std::optional<Environment> environment{};
  std::optional<double> duration_s{};  ///< default: to the trajectory's end
  std::uint64_t seed = 1;
  bool noise = true;
};
/// The recording that a vehicle on this path would bring home: folder/NAME.rawlog and what goes with it, NAME
/// being the trajectory's. The same seed gives the same bytes.
RecordingFiles simulate(const std::filesystem::path& trajectory, const std::filesystem::path& vehicle,
                        const std::filesystem::path& folder, const SimulatedDive& dive = {});

}  // namespace fathom
