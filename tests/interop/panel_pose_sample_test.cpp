// The panel's pose from the images of a recording that another program made, against its truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "core/linear_algebra.h"
#include "fiducials/panel_pose.h"
#include "fiducials/predicted_search.h"
#include "fiducials/single_marker_pose.h"
#include "image_files/image_file.h"
#include "panel/panel_map.h"
#include "recording/rawlog.h"
#include "recording/tum.h"
#include "sensors/vehicle.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

struct Frame {
  cv::Mat image;
  Pose T_camera_panel;  // truth
};

Pose interpolated(const std::vector<StampedPose>& path, const Time& time) {
  const auto after = std::lower_bound(path.begin() + 1, path.end() - 1, time,
                                      [](const StampedPose& pose, const Time& t) { return pose.time < t; });
  const auto before = after - 1;
  const double share = secondsBetween(before->time, time) / secondsBetween(before->time, after->time);
  const Pose &a = before->T_odom_robot, &b = after->T_odom_robot;
  return {slerp(a.rotation, b.rotation, share), a.position + share * (b.position - a.position)};
}

class SampleRecording {
 public:
  explicit SampleRecording(const std::string& name)
      : folder_(test::sharedData("data/sample/" + name)),
        map(readPanelMap(folder_ / "panel/panel.yaml")),
        camera(readVehicle(folder_ / "vehicle.yaml").camera->model) {}

  /// Every third image, for time's sake.
  std::vector<Frame> frames() const {
    const auto path = readTum(folder_ / "truth.tum");
    std::vector<Frame> frames;
    RawlogReader reader(folder_ / "recording.rawlog");
    int count = 0;
    while (const auto sample = reader.next()) {
      const auto* image = std::get_if<ImageSample>(&sample->reading);
      if (image == nullptr || count++ % 3 != 0) continue;
      const Pose T_odom_camera = interpolated(path, sample->time) * image->T_robot_camera;
      frames.push_back({readImage(reader.imageFolder() / std::filesystem::path(image->file).filename()),
                        T_odom_camera.inverse() * map.T_odom_panel});
    }
    return frames;
  }

 private:
  std::filesystem::path folder_;

 public:
  PanelMap map;
  CameraModel camera;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void expectCornersAndPoses(Backend backend) {
  const SampleRecording recording("none");
  DetectorOptions options;
  options.camera = recording.camera;
  const auto detector = makeDetector(backend, {"DICT_ARUCO_ORIGINAL"}, options);

  std::vector<double> corner_errors_px, corner_sigmas_px, joint_m, joint_rad, mean_m, mean_rad, nees;
  for (const Frame& frame : recording.frames()) {
    const auto detections = detector->detect(frame.image);
    for (const Detection& detection : detections) {
      const Marker* marker = markerOf(detection, recording.map);
      ASSERT_NE(marker, nullptr) << detection.id;
      const auto corners_panel = marker->corners_panel();
      for (std::size_t k = 0; k < 4; ++k)
        corner_errors_px.push_back(
            (recording.camera.project<double>(frame.T_camera_panel * corners_panel[k]) -
             detection.corners_px[k])
                .norm());
      corner_sigmas_px.push_back(detection.sigma_px());
    }
    const auto estimate = solvePanelPose(detections, recording.map, recording.camera);
    const auto mean = meanOfMarkers(detections, recording.map, recording.camera);
    if (detections.size() < 2) continue;
    ASSERT_TRUE(estimate.solved) << estimate.why_not;
    const auto& [pose, covariance] = estimate.T_camera_panel;
    Eigen::Matrix<double, 6, 1> error;
    error.head<3>() = frame.T_camera_panel.position - pose.position;
    error.tail<3>() = logSO3<double>(pose.rotation.transpose() * frame.T_camera_panel.rotation);
    joint_m.push_back(error.head<3>().norm());
    joint_rad.push_back(error.tail<3>().norm());
    mean_m.push_back((frame.T_camera_panel.position - mean->position).norm());
    mean_rad.push_back(angleBetween(frame.T_camera_panel.rotation, mean->rotation));
    nees.push_back(normalizedSquare(covariance, error));
  }
  std::cout << nameOf(backend) << ": " << corner_errors_px.size() / 4 << " markers, corner error median "
            << median(corner_errors_px) << " px (sigma stated " << median(corner_sigmas_px)
            << "); pose error median joint " << median(joint_m) << " m " << degrees(median(joint_rad))
            << " deg, mean of markers " << median(mean_m) << " m " << degrees(median(mean_rad))
            << " deg; NEES median " << median(nees) << "\n";
  EXPECT_LT(median(corner_errors_px), 0.35);
  EXPECT_LT(median(joint_m), 0.01);
  EXPECT_LT(median(joint_rad), radians(0.2));
  EXPECT_LT(*std::max_element(joint_m.begin(), joint_m.end()), 0.1);
  EXPECT_LT(median(joint_m), median(mean_m));
  EXPECT_LT(median(joint_rad), median(mean_rad));
}

TEST(PanelPoseSample, ArucoAgreesWithTruth) {
  FATHOM_NEEDS_SHARED("data/sample/none");
  expectCornersAndPoses(Backend::aruco);
}

TEST(PanelPoseSample, AprilTagAgreesWithTruth) {
  FATHOM_NEEDS_SHARED("data/sample/none");
  expectCornersAndPoses(Backend::apriltag);
}

}  // namespace
}  // namespace fathom
