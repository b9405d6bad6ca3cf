#include "sil/posed_images.h"

#include <algorithm>
#include <optional>

namespace fathom {
namespace {

/// By the panel whose position is known best.
std::optional<UncertainPose> robotPoseOf(const Sighting& sighting, const std::vector<PanelMap>& panels) {
  const auto& seen = sighting.panels.panels;
  const auto surest = std::min_element(seen.begin(), seen.end(), [](const SeenPanel& a, const SeenPanel& b) {
    return a.T_camera_panel.covariance.topLeftCorner<3, 3>().trace() <
           b.T_camera_panel.covariance.topLeftCorner<3, 3>().trace();
  });
  if (surest == seen.end()) return std::nullopt;
  return robotPose(surest->T_camera_panel, panels[static_cast<std::size_t>(surest->panel)].T_odom_panel,
                   sighting.panels.T_robot_camera);
}

std::string whyNot(const Sighting& sighting) {
  return sighting.unused.empty() ? "no marker of a panel" : sighting.unused.front().why;
}

}  // namespace

PosedImages posedImages(const std::vector<ImageEntry>& entries, const Detections& detections,
                        const Sightings& sightings, const std::vector<PanelMap>& panels) {
  std::map<std::filesystem::path, std::string> unreadable;
  for (const UnreadableImage& image : detections.unreadable) unreadable[image.file] = image.why;

  PosedImages images;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ImageEntry& entry = entries[i];
    const Sighting& sighting = sightings.by_entry.at(i);
    const auto T_odom_robot = robotPoseOf(sighting, panels);
    for (std::size_t eye = 0; eye < entry.eyes.size(); ++eye) {
      const auto& [image, T_first_camera] = entry.eyes[eye];
      const auto* found = detections.find(image.file);
      if (found == nullptr)
        images.unposed.push_back({entry.time, image.file, unreadable[image.file]});
      else if (!T_odom_robot)
        images.unposed.push_back({entry.time, image.file, whyNot(sighting)});
      else
        images.posed.push_back({entry.time, i, eye, image, *T_odom_robot,
                                T_odom_robot->pose * entry.T_robot_camera * T_first_camera, *found});
    }
  }
  return images;
}

}  // namespace fathom
