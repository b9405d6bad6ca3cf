#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "localization/localizer.h"
#include "localization/path_measures.h"
#include "panel/panel_map.h"
#include "recording/rawlog.h"
#include "report/run_info.h"

namespace fathom {

/// What is known of a recording when all tasks have run on it.
struct RecordingStory {
  RunInfo run;
  std::filesystem::path recording;
  Time time_zero;  ///< its first entry
  std::optional<RecordingLoss> loss;
  std::string reference_name;  ///< S; empty: none
  std::vector<StampedPose> reference;
  std::vector<StampedPose> marker_poses;                  ///< M, the paper's: T_odom_robot of each sighting
  std::vector<Time> image_times;                          ///< of all images
  std::optional<CameraModel> camera;                      ///< of the first image, of a pair the left one
  Pose T_robot_camera;                                    ///< likewise
  std::vector<PanelMap> panels;                           ///< what was looked for in them
  std::vector<StampedPose> plain, by_reference_attitude;  ///< dead reckoning, see DeadReckoning
  std::vector<std::string> remarks;                       ///< e.g. where vehicle file and recording disagree
};

/// The paper's measures of one estimate of the path, over the marker sightings.
struct TaskMeasures {
  std::optional<PathErrors> against_markers;    ///< d(M, F)
  std::optional<PathErrors> against_reference;  ///< d(S, F) at the same times
  std::optional<PathSmoothness> smoothness;     ///< m_A at the images' times
  std::size_t lost_sightings = 0;  ///< at which the task said that it was lost: they do not count
};
/// `lost` tells of each of the task's poses whether it said so; `path` is those poses, or the smoothed ones.
TaskMeasures measuresOf(const std::vector<StampedPose>& path, const std::vector<StampedPose>& poses,
                        const std::vector<bool>& lost, const RecordingStory& recording);

/// All that a finished task has to tell.
struct TaskStory {
  LocalizationOptions options;
  bool improved = false;  ///< the task as fathom does it, beside the paper's
  LocalizationSummary summary;
  std::optional<Evaluation> filter, smoother;  ///< every estimate against the reference
  TaskMeasures filter_measures, smoother_measures;
};

}  // namespace fathom
