#include "landmarks/landmark_source.h"

#include <atomic>

#include "core/for_each.h"
#include "sensors/camera_geometry.h"
#include "sensors/true_panel.h"

namespace fathom {
namespace {

/// One entry's camera and panels as they truly are.
class TrueEntry {
 public:
  TrueEntry(const ImageEntry& entry, const LandmarkCalibration& calibration)
      : entry_(entry),
        effects_(calibration.effects),
        t_s_(effects_.on.any() ? secondsBetween(calibration.time_zero, entry.time) : 0.0) {
    motion_.velocity_robot = entry.velocity_robot;
    motion_.angular_velocity_robot = entry.angular_velocity_robot;
  }

  Pose T_robot_camera() const {
    const auto mount = cameraMounting(entry_.T_robot_camera, effects_, t_s_);
    return {mount.R_robot_sensor, mount.position_robot};
  }

  std::vector<CameraDetections> seen(const Detections& detections) const {
    std::vector<CameraDetections> cameras;
    for (const ImageEntry::Eye& eye : entry_.eyes)
      if (const auto* found = detections.find(eye.image.file)) cameras.push_back(seen(eye, *found));
    return cameras;
  }

  /// With the markers where they truly are, in the frame in which T_odom_panel holds.
  std::vector<PanelMap> moved(const std::vector<PanelMap>& maps) const {
    std::vector<PanelMap> there;
    for (const PanelMap& map : maps) {
      PanelMap panel = truePanel(map, effects_, t_s_);
      const Pose T_map_panel = map.T_odom_panel.inverse() * panel.T_odom_panel;
      for (Marker& marker : panel.markers) marker.T_panel_marker = T_map_panel * marker.T_panel_marker;
      panel.T_odom_panel = map.T_odom_panel;
      there.push_back(std::move(panel));
    }
    return there;
  }

 private:
  CameraDetections seen(const ImageEntry::Eye& eye, const std::vector<Detection>& found) const {
    const CameraModel& nominal = eye.image.camera;
    const auto mount = cameraMounting(entry_.T_robot_camera, effects_, t_s_, eye.T_first_camera);
    const auto projector = movingWith(motion_, mount, cameraProjector(nominal, effects_, t_s_));
    CameraDetections seen{found, projector.lensModel(nominal), eye.T_first_camera};
    if (projector.port.present || projector.shutter.rolling) seen.projector = projector;
    return seen;
  }

  const ImageEntry& entry_;
  const EffectParameters<double>& effects_;
  double t_s_;
  KinematicState<double> motion_;
};

void count(Sightings& sightings) {
  for (const Sighting& sighting : sightings.by_entry) {
    if (sighting.robot || !sighting.unused.empty()) ++sightings.with_markers;
    sightings.panels_used += sighting.panels.panels.size();
    for (const UnusedPanel& unused : sighting.unused) ++sightings.panels_unused[unused.why];
  }
}

}  // namespace

Sightings solveSightings(const std::vector<ImageEntry>& entries, const Detections& detections,
                         const std::vector<PanelMap>& panels, const LandmarkCalibration& calibration,
                         const PanelPoseOptions& options) {
  Sightings sightings;
  sightings.by_entry.resize(entries.size());
  std::atomic<std::size_t> without_file = 0;
  const bool as_mapped = !movesPanels(calibration.effects);
  forEachIndex(entries.size(), "solving for the panels", [&](std::size_t i) {
    const TrueEntry entry(entries[i], calibration);
    const auto cameras = entry.seen(detections);
    if (cameras.size() < entries[i].eyes.size()) ++without_file;
    const auto solve = [&](const std::vector<PanelMap>& there) {
      return sightingOf(cameras, entry.T_robot_camera(), there, options);
    };
    sightings.by_entry[i] = as_mapped ? solve(panels) : solve(entry.moved(panels));
  });
  sightings.without_file = without_file;
  count(sightings);
  return sightings;
}

LandmarkSource::LandmarkSource(std::unique_ptr<SampleSource> source,
                               std::shared_ptr<const Sightings> sightings)
    : source_(std::move(source)), sightings_(std::move(sightings)) {}

std::optional<Sample> LandmarkSource::next() {
  if (!derived_.empty()) {
    Sample sample = std::move(derived_.front());
    derived_.pop_front();
    return sample;
  }
  auto sample = source_->next();
  if (sample && isImage(*sample)) derive(sightings_->by_entry.at(entry_++), sample->time);
  return sample;
}

void LandmarkSource::derive(const Sighting& sighting, Time time) {
  const auto emit = [&](const char* label, Reading reading) {
    derived_.push_back({time, label, std::move(reading)});
  };
  if (sighting.robot) emit(labels::kMarkers, *sighting.robot);
  if (!sighting.panels.panels.empty()) emit(labels::kPanel, sighting.panels);
  if (!sighting.markers.markers.empty()) emit(labels::kMarkerSights, sighting.markers);
}

}  // namespace fathom
