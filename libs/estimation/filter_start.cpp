#include "estimation/filter_start.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "core/for_each.h"
#include "core/stable_sort.h"
#include "fiducials/panel_pose.h"
#include "landmarks/landmark_source.h"
#include "localization/localizer.h"

namespace fathom {
namespace {

constexpr double kLoosely_m = 100.0, kLoosely_rad = 3.0;
constexpr double kByDefinition_m = 1e-3, kByDefinition_rad = 1e-3;

/// What one image, or a pair, saw of one panel.
struct View {
  std::vector<CameraDetections> cameras;
  double t_s = 0;
  Pose T_robot_camera;
  std::size_t markers = 0;

  std::size_t panel = 0;

  void add(const BatchMarker& seen) {
    if (cameras.empty()) {
      t_s = seen.t_s;
      T_robot_camera = seen.T_robot_camera;
      panel = seen.panel;
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

/// Of each image the panel that it shows the most markers of, by time.
std::vector<View> viewsOf(const BatchData& data) {
  std::map<std::size_t, std::map<std::size_t, View>> by_image;  // and panel
  for (const BatchMarker& seen : data.markers) by_image[seen.image][seen.panel].add(seen);
  std::vector<View> views;
  for (const auto& [image, panels] : by_image)
    views.push_back(std::max_element(panels.begin(), panels.end(), [](const auto& a, const auto& b) {
                      return a.second.markers < b.second.markers;
                    })->second);
  stableSort(views, [](const View& a, const View& b) { return a.t_s < b.t_s; });
  return views;
}

std::optional<Pose> solve(const BatchData& data, const View& view) {
  const PanelMap& map = data.panels[view.panel];
  const PanelPoseEstimate solved = solvePanelPose(view.cameras, map);
  if (!solved.solved) return std::nullopt;
  return robotPose(solved.T_camera_panel, map.T_odom_panel, view.T_robot_camera).pose;
}

bool tellsPosition(const BatchData& data) {
  for (std::size_t i = 0; i < data.readings.size(); ++i)
    if (!data.readings[i].empty() && kChannelTexts[i].tells == ChannelText::Tells::position) return true;
  return false;
}

Pose poseNear(const StartPath& path, double t_s) {
  const auto found = std::lower_bound(path.times_s.begin(), path.times_s.end(), t_s);
  const auto i = std::min(found - path.times_s.begin(), std::ssize(path.times_s) - 1);
  return path.T_odom_robot[static_cast<std::size_t>(i)];
}

/// Where the path has to begin so that it meets the first image's markers; nothing where it does. Without a
/// start pose the filter begins anywhere, and comes upon the panels only later.
std::optional<StartPose> betterStart(const BatchData& data, const StartPath& path) {
  constexpr double kNear_m = 0.5, kNear_rad = radians(5.0);
  for (const View& view : viewsOf(data)) {
    const auto seen = solve(data, view);
    if (!seen) continue;
    const Pose T_new_old = *seen * poseNear(path, view.t_s).inverse();
    const Pose start = T_new_old * path.T_odom_robot.front();
    const Vector6d change = poseDifference(path.T_odom_robot.front(), start);
    if (change.head<3>().norm() < kNear_m && change.tail<3>().norm() < kNear_rad) return std::nullopt;
    return StartPose{start, kNear_m, kNear_rad, "the first image's markers"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<PathPrior> StartPath::prior(const BatchData& data) const {
  if (!data.hasMotion() || T_odom_robot.empty()) return std::nullopt;
  if (given) return PathPrior{given->T_odom_robot, given->position_sigma_m, given->angle_sigma_rad};
  const bool located = !data.markers.empty() || tellsPosition(data);
  if (located) return PathPrior{T_odom_robot.front(), kLoosely_m, kLoosely_rad};
  return PathPrior{
      T_odom_robot.front(), kByDefinition_m,
      data.of<Attitude>().empty() && data.of<Compass>().empty() ? kByDefinition_rad : kLoosely_rad};
}

StartPath filterStart(const BatchData& data, SampleSource& samples,
                      const EffectParameters<double>& calibration, const std::optional<StartPose>& start) {
  LocalizationSetup setup;
  setup.vehicle = data.vehicle;
  setup.calibration = calibration;
  setup.options.task = "start of the batch estimate";
  setup.options.fuse.clear();
  std::copy_if(kEveryChannel.begin(), kEveryChannel.end(), std::back_inserter(setup.options.fuse),
               [](Channel channel) { return textOf(channel).is_filtered; });
  setup.options.smooth = true;
  setup.start = start;
  setup.time_zero = data.time_zero;
  for (const PanelMap& panel : data.panels)
    setup.panels.push_back({panel.name, panel.T_odom_panel, panel.position_sigma_m, panel.angle_sigma_rad});
  StartPath path;
  LocalizationSink sink;
  sink.smoothed = [&](const Estimate& e) {
    path.times_s.push_back(e.t_s);
    path.T_odom_robot.push_back({e.state.motion.R_odom_robot, e.state.motion.position_odom});
  };
  const LocalizationSummary summary = localize(
      setup, [&] { return samples.next(); }, sink);
  path.source = summary.started ? "filter, smoothed; begun from " + summary.start_source : summary.failure;
  return path;
}

StartPath imageStart(const BatchData& data) {
  const std::vector<View> views = viewsOf(data);
  std::vector<std::optional<Pose>> poses(views.size());
  forEachIndex(views.size(), "solving images", [&](std::size_t i) { poses[i] = solve(data, views[i]); });
  StartPath path;
  path.source = "each image's markers";
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!poses[i]) continue;
    path.times_s.push_back(views[i].t_s);
    path.T_odom_robot.push_back(*poses[i]);
  }
  if (path.T_odom_robot.empty()) path.source = "no image shows a panel well enough";
  return path;
}

BatchInput batchInput(const std::function<std::unique_ptr<SampleSource>()>& open,
                      const Detections& detections, const Vehicle& vehicle,
                      const std::vector<PanelMap>& panels, const EffectParameters<double>& calibration,
                      const std::optional<StartPose>& start, const BatchDataOptions& options) {
  BatchInput input;
  input.data = collectBatch(*open(), detections, vehicle, panels, options);
  if (!input.data.hasMotion()) {
    if (input.data.markers.empty())
      input.start.source = "where the robot is does not matter to tie points";
    else
      input.start = imageStart(input.data);
    return input;
  }
  const auto entries = imageEntries(*open(), vehicle);
  const auto sightings = std::make_shared<Sightings>(solveSightings(entries, detections, panels));
  const auto filter = [&](const std::optional<StartPose>& from) {
    LandmarkSource samples(open(), sightings);
    return filterStart(input.data, samples, calibration, from);
  };
  input.start = filter(start);
  if (!start && !input.start.T_odom_robot.empty())
    if (const auto better = betterStart(input.data, input.start)) input.start = filter(better);
  input.start.given = start;
  return input;
}

}  // namespace fathom
