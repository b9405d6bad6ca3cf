#include "tasks/task_story.h"

#include <algorithm>

namespace fathom {

namespace {

/// Whether the latest of the poses up to a time was said to be lost.
bool wasLost(const std::vector<StampedPose>& poses, const std::vector<bool>& lost, const Time& time) {
  const auto next = std::upper_bound(poses.begin(), poses.end(), time,
                                     [](const Time& t, const StampedPose& pose) { return t < pose.time; });
  return next != poses.begin() && lost[static_cast<std::size_t>(next - poses.begin()) - 1];
}

}  // namespace

TaskMeasures measuresOf(const std::vector<StampedPose>& path, const std::vector<StampedPose>& poses,
                        const std::vector<bool>& lost, const RecordingStory& recording) {
  std::vector<StampedPose> markers, reference;
  for (const StampedPose& sighting : recording.marker_poses) {
    if (wasLost(poses, lost, sighting.time)) continue;
    markers.push_back(sighting);
    if (const auto pose = poseAt(recording.reference, sighting.time))
      reference.push_back({sighting.time, *pose});
  }
  return {errorsAgainst(markers, path), errorsAgainst(reference, path),
          smoothnessOf(path, recording.image_times), recording.marker_poses.size() - markers.size()};
}

}  // namespace fathom
