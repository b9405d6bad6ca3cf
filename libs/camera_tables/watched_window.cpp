#include "camera_tables/watched_window.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <stdexcept>

#include "core/linear_algebra.h"
#include "core/text.h"
#include "core/uncertain_pose.h"
#include "core/yaml.h"
#include "sensors/vehicle.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr double kCentimetre = 0.01;
constexpr std::size_t kFewestWindowCorners = 4;
constexpr double kFlat = 0.02;  // of the corners' spread: so far may they lie off a line or off their plane
constexpr int kRoom_px = 20;    // around what is seen
constexpr double kFarthest_px = 10000;  // off the middle: beyond it, no camera sees

/// A plane that the corners lie in, in their own frame.
struct Plane {
  Vector3d centre, normal;
};

std::optional<Plane> planeOf(const std::vector<Vector3d>& corners) {
  const Eigen::Map<const Eigen::Matrix3Xd> all(corners[0].data(), 3, std::ssize(corners));
  const Vector3d centre = all.rowwise().mean();
  const Eigen::Matrix3Xd off = all.colwise() - centre;
  const SymmetricEigen scatter = eigenOf(off * off.transpose());
  const Vector3d spread = scatter.values.cwiseMax(0).cwiseSqrt();
  if (spread[1] < kFlat * spread[2] || spread[0] > kFlat * spread[2]) return std::nullopt;
  return Plane{centre, scatter.vectors.col(0)};
}

Vector2d straightIdeal(const WatchedWindow& window, const Vector2d& pixel) {
  const cv::Matx33d K(window.pinhole.fx_px, 0, window.pinhole.cx_px, 0, window.pinhole.fy_px,
                      window.pinhole.cy_px, 0, 0, 1);
  const std::vector<cv::Point2d> seen{{pixel.x(), pixel.y()}};
  std::vector<cv::Point2d> ideal;
  cv::undistortPoints(seen, ideal, K, window.distortion, cv::noArray(), cv::noArray(),
                      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 500, 1e-12));
  return {ideal[0].x, ideal[0].y};
}

/// Pose T_camera_world with its covariance (see UncertainPose; position in camera axes, turn in world's).
UncertainPose placed(const WatchedWindow& window, double corner_sigma_px) {
  std::vector<cv::Point3d> corners;
  std::vector<cv::Point2d> ideal;
  for (std::size_t i = 0; i < window.corners_m.size(); ++i) {
    const Vector3d& corner = window.corners_m[i];
    const Vector2d at = straightIdeal(window, window.corners_px[i]);
    corners.emplace_back(corner.x(), corner.y(), corner.z());
    ideal.emplace_back(at.x(), at.y());
  }
  cv::Mat turn, shift;
  const cv::Matx33d eye = cv::Matx33d::eye();
  const std::invalid_argument nowhere("no place from which the corners look like that");
  try {
    if (!cv::solvePnP(corners, ideal, eye, cv::noArray(), turn, shift, false, cv::SOLVEPNP_SQPNP))
      throw nowhere;
    cv::solvePnPRefineLM(corners, ideal, eye, cv::noArray(), turn, shift);
  } catch (const cv::Exception&) {
    throw nowhere;
  }
  UncertainPose result;
  result.pose = {expSO3<double>(Vector3d(turn.at<double>(0), turn.at<double>(1), turn.at<double>(2))),
                 Vector3d(shift.at<double>(0), shift.at<double>(1), shift.at<double>(2))};
  // Least squares with the sigma that the corners themselves show, few as they are.
  Matrix6d normal = Matrix6d::Zero();
  double square = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d p = result.pose * window.corners_m[i];
    if (p.z() <= 0) throw std::invalid_argument("the corners would be behind the camera");
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
    Eigen::Matrix<double, 2, 6> J;
    J << by_point, -by_point * result.pose.rotation * crossMatrix<double>(window.corners_m[i]);
    normal += J.transpose() * J;
    square += (Vector2d(p.x() / p.z(), p.y() / p.z()) - Vector2d(ideal[i].x, ideal[i].y)).squaredNorm();
  }
  const double freedom = 2 * static_cast<double>(corners.size()) - 6;
  const double stated = std::pow(corner_sigma_px / window.pinhole.fx_px, 2);
  result.covariance = std::max(stated, square / freedom) * inverseOf(normal);
  return result;
}

Window windowOf(const WatchedWindow& window, const Pose& T_camera_world) {
  const auto plane = planeOf(window.corners_m);
  const Vector3d centre = T_camera_world * plane->centre;
  Vector3d normal = T_camera_world.rotation * plane->normal;
  if (normal.dot(centre) < 0) normal = -normal;
  if (normal.z() <= 0) throw std::invalid_argument("the window is not before the camera");
  // Exp(tilt_x, tilt_y, 0) z = normal.
  const double sine = std::hypot(normal.x(), normal.y());
  const double scale = sine > 0 ? std::atan2(sine, normal.z()) / sine : 0;
  return {normal.dot(centre), -scale * normal.y(), scale * normal.x()};
}

/// A pinhole whose image has room for all that is seen.
CameraModel pinholeFor(const WatchedWindow& window, const std::vector<Vector2d>& seen_px) {
  const Vector2d focal_px(window.pinhole.fx_px, window.pinhole.fy_px);
  Vector2d low = Vector2d::Zero(), high = Vector2d::Zero();
  for (const Vector2d& pixel : seen_px) {
    const Vector2d place = focal_px.cwiseProduct(straightIdeal(window, pixel));
    if (!place.allFinite() || place.cwiseAbs().maxCoeff() > kFarthest_px)
      throw std::invalid_argument(
          print("what is seen at (%g, %g) px would lie more than %g px off the middle", pixel.x(), pixel.y(),
                kFarthest_px));
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  const Eigen::Vector2i before = (-low).array().ceil().cast<int>() + kRoom_px,
                        behind = high.array().ceil().cast<int>() + kRoom_px;
  CameraModel camera;
  camera.fx_px = focal_px.x();
  camera.fy_px = focal_px.y();
  camera.cx_px = before.x();
  camera.cy_px = before.y();
  camera.width_px = before.x() + behind.x();
  camera.height_px = before.y() + behind.y();
  return camera;
}

}  // namespace

StraightPixel WatchedWindow::straightened(const Vector2d& pixel, const CameraModel& camera) const {
  const auto at = [&](const Vector2d& p) {
    const Vector2d ideal = straightIdeal(*this, p);
    return Vector2d(camera.fx_px * ideal.x() + camera.cx_px, camera.fy_px * ideal.y() + camera.cy_px);
  };
  constexpr double kStep_px = 0.5;
  Eigen::Matrix2d J;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const Vector2d step = kStep_px * Vector2d::Unit(axis);
    J.col(axis) = (at(pixel + step) - at(pixel - step)) / (2 * kStep_px);
  }
  return {at(pixel), J.norm() / std::sqrt(2.0)};
}

WatchedWindow readWatchedWindow(const fs::path& file) {
  const YamlFile yaml(file);
  const YamlMap& root = yaml.root();
  WatchedWindow window;
  readPinhole(root, window.pinhole);
  if (root.has("distortion")) window.distortion = root.numbers("distortion");
  const std::size_t d = window.distortion.size();
  if (d != 0 && d != 4 && d != 5 && d != 8 && d != 12 && d != 14)
    throw root.error("distortion", "must be 4, 5, 8, 12 or 14 numbers, in OpenCV's order");
  for (const YamlMap& corner : root.maps("reference_corners")) {
    window.corners_px.emplace_back(corner.number("u_px"), corner.number("v_px"));
    window.corners_m.emplace_back(
        kCentimetre * Vector3d(corner.number("x_cm"), corner.number("y_cm"), corner.number("z_cm")));
  }
  yaml.rejectUnknownKeys();
  if (window.corners_m.size() < kFewestWindowCorners)
    throw root.error("reference_corners", print("must be %zu or more", kFewestWindowCorners));
  if (!planeOf(window.corners_m)) throw root.error("reference_corners", "must span a plane, and lie in it");
  return window;
}

StereoRig placeCameras(const std::array<WatchedWindow, 2>& windows, double corner_sigma_px,
                       const std::array<std::vector<Vector2d>, 2>& seen_px) {
  StereoRig rig;
  std::array<UncertainPose, 2> T_camera_world;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const WatchedWindow& window = windows[eye];
    T_camera_world[eye] = placed(window, corner_sigma_px);
    CameraModel& camera = rig.cameras[eye];
    camera = pinholeFor(window, seen_px[eye]);
    camera.window = windowOf(window, T_camera_world[eye].pose);
    double square = 0;
    for (std::size_t i = 0; i < window.corners_m.size(); ++i)
      square += (camera.project<double>(T_camera_world[eye].pose * window.corners_m[i]) -
                 window.straightened(window.corners_px[i], camera).pixel)
                    .squaredNorm();
    rig.corner_rms_px[eye] = std::sqrt(square / (2 * static_cast<double>(window.corners_m.size())));
  }
  const UncertainPose T_world_right = T_camera_world[1].inverse();
  const LinkedPose both = composed(T_camera_world[0].pose, T_world_right.pose);
  rig.T_left_right = both.pose;
  const Matrix6d covariance = both.wrt_first * T_camera_world[0].covariance * both.wrt_first.transpose() +
                              both.wrt_second * T_world_right.covariance * both.wrt_second.transpose();
  rig.position_sigma_m = std::sqrt(covariance.diagonal().head<3>().mean());
  rig.angle_sigma_rad = std::sqrt(covariance.diagonal().tail<3>().mean());
  return rig;
}

}  // namespace fathom
