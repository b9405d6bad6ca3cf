#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tasks/sample_chain.h"
#include "tasks/task_run.h"

namespace fathom {

/// What is to be done with one recording.
struct RecordingJob {
  ChainOptions chain;
  std::filesystem::path folder;
  std::vector<TaskSpec> tasks;
  std::string reference, faults;  ///< files; empty: none
  std::string start = "auto";     ///< see startPose()
  std::string command_line;
};

/// Whether its images are looked at: a task fuses landmarks, or several are compared at the sightings.
bool needsLandmarks(const RecordingJob& job);

/// A recording with all its tasks done and all files written but for the reports.
struct LocalizedRecording {
  std::unique_ptr<RecordingStory> story;  ///< where it is, the tasks look at it
  std::vector<std::unique_ptr<TaskRun>> tasks;
};

/// Detects (or takes the cached detections), runs all tasks side by side, and writes NAME_results.rawlog and
/// each task's files: in the folder itself where there is one task, else in a folder of the task's id. Throws
/// Error, Interrupted.
LocalizedRecording localizeRecording(const RecordingJob& job);

}  // namespace fathom
