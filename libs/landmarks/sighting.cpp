#include "landmarks/sighting.h"

#include <algorithm>
#include <set>

#include "fiducials/single_marker_pose.h"

namespace fathom {
namespace {

/// A lone marker's eight coordinates leave but two to judge the corners by. Where those are worse than they
/// say (JPEG's are), nothing shows it, and the mirror image may fit better by more than chance allows: it
/// must be far worse then.
constexpr double kLoneMarkerChiSquare = 200;

std::size_t countOn(const PanelMap& panel, const std::vector<Detection>& detections) {
  return static_cast<std::size_t>(
      std::count_if(detections.begin(), detections.end(),
                    [&](const Detection& detection) { return markerOf(detection, panel) != nullptr; }));
}

/// The running mean of poses, each of a weight.
struct MeanPose {
  std::optional<Pose> pose;
  double weight = 0;

  void add(const Pose& other, double other_weight) {
    weight += other_weight;
    const double share = other_weight / weight;
    if (!pose) pose = other;
    pose->position += share * (other.position - pose->position);
    pose->rotation = slerp(pose->rotation, other.rotation, share);
  }
};

/// What single markers can be solved from, which know pinholes only: where the camera is none, nothing
/// without the joint solution.
std::vector<Detection> forPinhole(const CameraDetections& seen, const PanelMap& panel,
                                  const PanelPoseEstimate& joint) {
  if (!seen.projector) return seen.detections;
  if (!joint.solved) return {};
  return straightened(seen, panel, joint.T_camera_panel.pose);
}

/// `joint` are the joint solutions, by panel.
std::optional<PoseSample> meanRobot(const std::vector<CameraDetections>& cameras, const Pose& T_robot_camera,
                                    const std::vector<PanelMap>& panels,
                                    const std::vector<PanelPoseEstimate>& joint) {
  MeanPose mean;
  for (std::size_t i = 0; i < panels.size(); ++i)
    for (const CameraDetections& seen : cameras) {
      const PanelMap& panel = panels[i];
      const auto T_camera_panel = meanOfMarkers(forPinhole(seen, panel, joint[i]), panel, seen.camera);
      if (!T_camera_panel) continue;
      const Pose T_robot_panel = T_robot_camera * seen.T_first_camera * *T_camera_panel;
      mean.add(panel.T_odom_panel * T_robot_panel.inverse(),
               static_cast<double>(countOn(panel, seen.detections)));
    }
  if (!mean.pose) return std::nullopt;
  PoseSample sample;
  sample.T_odom_robot.mean = *mean.pose;
  sample.T_odom_robot.covariance = Matrix6d::Identity();
  sample.T_robot_sensor = T_robot_camera;
  return sample;
}

/// Range, yaw and pitch of a marker's centre, with the covariance that the panel's pose gives them.
SeenMarker seenMarker(const Marker& marker, const UncertainPose& T_camera_panel) {
  const auto& [pose, covariance] = T_camera_panel;
  const Vector3d centre_panel = marker.T_panel_marker.position;
  const Matrix3d R_forward_camera = forwardFrame().rotation.transpose();
  const Vector3d p = R_forward_camera * (pose * centre_panel);

  SeenMarker seen;
  const double across_m = p.head<2>().norm();
  seen.id = marker.id;
  seen.range_m = p.norm();
  seen.yaw_rad = std::atan2(p.y(), p.x());
  seen.pitch_rad = -std::atan2(p.z(), across_m);

  Eigen::Matrix<double, 3, 6> centre_by_pose;  // of R Exp(dr) c + p + dp
  centre_by_pose << R_forward_camera, -R_forward_camera * pose.rotation * crossMatrix(centre_panel);
  Matrix3d by_centre;
  by_centre.row(0) = p.transpose() / seen.range_m;
  by_centre.row(1) = Vector3d(-p.y(), p.x(), 0).transpose() / (across_m * across_m);
  by_centre.row(2) = Vector3d(p.x() * p.z(), p.y() * p.z(), -across_m * across_m).transpose() /
                     (across_m * seen.range_m * seen.range_m);
  const Eigen::Matrix<double, 3, 6> J = by_centre * centre_by_pose;
  seen.covariance = J * covariance * J.transpose();
  return seen;
}

/// The inliers of a solution, each marker once, whichever camera saw it.
void addMarkers(const PanelPoseEstimate& estimate, const std::vector<CameraDetections>& cameras,
                const PanelMap& panel, std::vector<SeenMarker>& markers) {
  std::set<const Marker*> added;
  for (const MarkerFit& fit : estimate.markers) {
    const Marker* marker = markerOf(cameras[fit.camera].detections[fit.detection], panel);
    if (fit.inlier && added.insert(marker).second)
      markers.push_back(seenMarker(*marker, estimate.T_camera_panel));
  }
}

std::size_t countOn(const PanelMap& panel, const std::vector<CameraDetections>& cameras) {
  std::size_t count = 0;
  for (const CameraDetections& seen : cameras) count += countOn(panel, seen.detections);
  return count;
}

}  // namespace

Pose forwardFrame() {
  Matrix3d R_camera_forward;
  R_camera_forward << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return {R_camera_forward, Vector3d::Zero()};
}

Sighting sightingOf(const std::vector<CameraDetections>& cameras, const Pose& T_robot_camera,
                    const std::vector<PanelMap>& panels, const PanelPoseOptions& options) {
  Sighting sighting{{}, {T_robot_camera, {}}, {T_robot_camera * forwardFrame(), {}}, {}};
  std::vector<PanelPoseEstimate> estimates;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::size_t count = countOn(panels[i], cameras);
    const int index = static_cast<int>(i);
    PanelPoseOptions panel_options = options;
    if (count == 1)
      panel_options.ambiguity_chi_square = std::max(options.ambiguity_chi_square, kLoneMarkerChiSquare);
    const auto& estimate = estimates.emplace_back(
        count > 0 ? solvePanelPose(cameras, panels[i], panel_options) : PanelPoseEstimate{});
    if (count == 0) continue;
    if (!estimate.solved || estimate.isAmbiguous()) {
      sighting.unused.push_back({index, estimate.solved ? kAmbiguous : estimate.why_not});
      continue;
    }
    sighting.panels.panels.push_back({index, estimate.T_camera_panel});
    addMarkers(estimate, cameras, panels[i], sighting.markers.markers);
  }
  sighting.robot = meanRobot(cameras, T_robot_camera, panels, estimates);
  return sighting;
}

}  // namespace fathom
