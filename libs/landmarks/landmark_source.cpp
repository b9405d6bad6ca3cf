#include "landmarks/landmark_source.h"

#include <atomic>

#include "core/for_each.h"
#include "imaging/detected_corners.h"
#include "imaging/true_panel.h"

namespace fathom {
namespace {

/// Corners where they are without white that has grown over black by so much. (What a response does to edges
/// depends on how dark they are, and is left.)
void takeBack(double spread_px, const std::vector<PanelMap>& panels, std::vector<Detection>& detections) {
  const MarkerLook look = panels.empty() ? MarkerLook{} : panels.front().look();
  for (Detection& detection : detections)
    detection.corners_px = withWhiteSpread(detection.corners_px, -spread_px, detection.family, look);
}

std::vector<CameraDetections> seenIn(const ImageEntry& entry, const Detections& detections,
                                     const std::vector<PanelMap>& panels,
                                     const LandmarkCalibration& calibration) {
  std::vector<CameraDetections> cameras;
  EdgeSpread<double> edges;
  applyEffects(calibration.effects.of(entry.instance), calibration.stamp_s(entry.time), edges);
  for (const ImageEntry::Eye& eye : entry.eyes) {
    const auto* found = detections.find(eye.image.file);
    if (found == nullptr) continue;
    const TrueCamera camera = trueCamera(entry, eye, calibration);
    CameraDetections& seen = cameras.emplace_back(CameraDetections{*found, camera.lens, eye.T_first_camera});
    if (camera.bends()) seen.projector = camera.projector;
    if (edges.white_px != 0) takeBack(edges.white_px, panels, seen.detections);
  }
  return cameras;
}

/// With the markers where they truly are, in the frame in which T_odom_panel holds.
std::vector<PanelMap> truePanels(const std::vector<PanelMap>& maps, const EffectParameters<double>& effects,
                                 double t_s) {
  std::vector<PanelMap> there;
  for (const PanelMap& map : maps) {
    PanelMap panel = truePanel(map, effects, t_s);
    const Pose T_map_panel = map.T_odom_panel.inverse() * panel.T_odom_panel;
    for (Marker& marker : panel.markers) marker.T_panel_marker = T_map_panel * marker.T_panel_marker;
    panel.T_odom_panel = map.T_odom_panel;
    there.push_back(std::move(panel));
  }
  return there;
}

void count(Sightings& sightings) {
  for (const Sighting& sighting : sightings.by_entry) {
    if (sighting.robot || !sighting.unused.empty()) ++sightings.with_markers;
    sightings.panels_used += sighting.panels.panels.size();
    for (const UnusedPanel& unused : sighting.unused) ++sightings.panels_unused[unused.why];
  }
}

}  // namespace

TrueCamera trueCamera(const ImageEntry& entry, const ImageEntry::Eye& eye,
                      const LandmarkCalibration& calibration) {
  KinematicState<double> motion;
  motion.velocity_robot = entry.velocity_robot;
  motion.angular_velocity_robot = entry.angular_velocity_robot;
  return trueCamera(eye.image.camera, entry.T_robot_camera, motion, calibration.effects.of(entry.instance),
                    calibration.stamp_s(entry.time), eye.T_first_camera);
}

Sightings solveSightings(const std::vector<ImageEntry>& entries, const Detections& detections,
                         const std::vector<PanelMap>& panels, const LandmarkCalibration& calibration,
                         const PanelPoseOptions& options) {
  Sightings sightings;
  sightings.by_entry.resize(entries.size());
  std::atomic<std::size_t> without_file = 0;
  const bool as_mapped = !movesPanels(calibration.effects);
  forEachIndex(entries.size(), "solving for the panels", [&](std::size_t i) {
    const ImageEntry& entry = entries[i];
    const double t_s = calibration.stamp_s(entry.time);
    const auto cameras = seenIn(entry, detections, panels, calibration);
    if (cameras.size() < entry.eyes.size()) ++without_file;
    const auto mount = cameraMounting(entry.T_robot_camera, calibration.effects.of(entry.instance), t_s);
    const auto solve = [&](const std::vector<PanelMap>& there) {
      return sightingOf(cameras, {mount.R_robot_sensor, mount.position_robot}, there, options);
    };
    sightings.by_entry[i] = as_mapped ? solve(panels) : solve(truePanels(panels, calibration.effects, t_s));
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
  if (sample && isImage(*sample)) derive(sightings_->by_entry.at(entry_++), *sample);
  return sample;
}

void LandmarkSource::derive(const Sighting& sighting, const Sample& image) {
  const Instance instance = Instance::of(image.label);
  const auto emit = [&](const char* label, Reading reading) {
    derived_.push_back({image.time, instance.label(label), std::move(reading)});
  };
  if (sighting.robot) emit(labels::kMarkers, *sighting.robot);
  if (!sighting.panels.panels.empty()) emit(labels::kPanel, sighting.panels);
  if (!sighting.markers.markers.empty()) emit(labels::kMarkerSights, sighting.markers);
}

}  // namespace fathom
