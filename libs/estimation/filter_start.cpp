#include "estimation/filter_start.h"

#include <algorithm>
#include <map>

#include "fiducials/panel_pose.h"
#include "landmarks/landmark_source.h"
#include "localization/localizer.h"

namespace fathom {
namespace {

constexpr double kLoosely_m = 100.0, kLoosely_rad = 3.0;
constexpr double kByDefinition_m = 1e-3, kByDefinition_rad = 1e-3;

/// What one image saw of one panel.
struct View {
  std::vector<CameraDetections> cameras;
  double t_s = 0;
  Pose T_robot_camera;
  std::size_t markers = 0;

  void add(const BatchMarker& seen) {
    if (cameras.empty()) {
      t_s = seen.t_s;
      T_robot_camera = seen.T_robot_camera;
    }
    const auto camera = std::find_if(cameras.begin(), cameras.end(), [&](const CameraDetections& c) {
      return c.T_first_camera.position == seen.T_left_right.position;
    });
    ++markers;
    if (camera == cameras.end())
      cameras.push_back({{seen.detection}, seen.camera, seen.T_left_right});
    else
      camera->detections.push_back(seen.detection);
  }
};

}  // namespace

std::optional<PathPrior> StartPath::prior(const BatchData& data) const {
  if (!data.hasMotion() || T_odom_robot.empty()) return std::nullopt;
  if (given) return PathPrior{given->T_odom_robot, given->position_sigma_m, given->angle_sigma_rad};
  const bool located = !data.markers.empty() || !data.usbl.empty();
  if (located) return PathPrior{T_odom_robot.front(), kLoosely_m, kLoosely_rad};
  return PathPrior{T_odom_robot.front(), kByDefinition_m,
                   data.attitude.empty() ? kByDefinition_rad : kLoosely_rad};
}

StartPath filterStart(const BatchData& data, SampleSource& samples, const EffectParameters<double>& calibration,
                      const std::optional<StartPose>& start) {
  LocalizationSetup setup;
  setup.vehicle = data.vehicle;
  setup.calibration = calibration;
  setup.options.task = "start of the batch estimate";
  setup.options.fuse.assign(kAllChannels.begin(), kAllChannels.end());
  setup.options.smooth = true;
  setup.start = start;
  setup.time_zero = data.time_zero;
  for (const PanelMap& panel : data.panels)
    setup.panels.push_back({panel.name, panel.T_odom_panel, panel.position_sigma_m, panel.angle_sigma_rad});
  StartPath path;
  path.given = start;
  LocalizationSink sink;
  sink.smoothed = [&](const Estimate& e) {
    path.times_s.push_back(e.t_s);
    path.T_odom_robot.push_back({e.state.motion.R_odom_robot, e.state.motion.position_odom});
  };
  const LocalizationSummary summary = localize(setup, [&] { return samples.next(); }, sink);
  path.source = summary.started ? "filter, smoothed; begun from " + summary.start_source : summary.failure;
  return path;
}

StartPath imageStart(const BatchData& data) {
  std::map<std::size_t, std::map<std::size_t, View>> views;  // by image, panel
  for (const BatchMarker& seen : data.markers) views[seen.image][seen.panel].add(seen);
  StartPath path;
  path.source = "each image's markers";
  for (const auto& [image, panels] : views) {
    const auto most = std::max_element(panels.begin(), panels.end(), [](const auto& a, const auto& b) {
      return a.second.markers < b.second.markers;
    });
    const View& view = most->second;
    const PanelMap& map = data.panels[most->first];
    const PanelPoseEstimate solved = solvePanelPose(view.cameras, map);
    if (!solved.solved) continue;
    path.times_s.push_back(view.t_s);
    path.T_odom_robot.push_back(
        robotPose(solved.T_camera_panel, map.T_odom_panel, view.T_robot_camera).pose);
  }
  if (path.T_odom_robot.empty()) path.source = "no image shows a panel well enough";
  return path;
}

BatchInput batchInput(const std::function<std::unique_ptr<SampleSource>()>& open, const Detections& detections,
                      const Vehicle& vehicle, const std::vector<PanelMap>& panels,
                      const EffectParameters<double>& calibration, const std::optional<StartPose>& start,
                      const BatchDataOptions& options) {
  BatchInput input;
  input.data = collectBatch(*open(), detections, vehicle, panels, options);
  if (!input.data.hasMotion()) {
    input.start = imageStart(input.data);
    return input;
  }
  const auto entries = imageEntries(*open());
  LandmarkSource samples(open(),
                         std::make_shared<Sightings>(solveSightings(entries, detections, panels)));
  input.start = filterStart(input.data, samples, calibration, start);
  return input;
}

}  // namespace fathom
