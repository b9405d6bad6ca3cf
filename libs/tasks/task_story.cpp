#include "tasks/task_story.h"

namespace fathom {

TaskMeasures measuresOf(const std::vector<StampedPose>& path, const RecordingStory& recording) {
  std::vector<StampedPose> reference;
  for (const StampedPose& sighting : recording.marker_poses)
    if (const auto pose = poseAt(recording.reference, sighting.time))
      reference.push_back({sighting.time, *pose});
  return {errorsAgainst(recording.marker_poses, path), errorsAgainst(reference, path),
          smoothnessOf(path, recording.image_times)};
}

}  // namespace fathom
