#include "fiducials/panel_pose.h"

#include <ceres/jet.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/chi_square.h"
#include "core/linear_algebra.h"
#include "core/median.h"
#include "fiducials/single_marker_pose.h"

namespace fathom {
namespace {

using Matrix86d = Eigen::Matrix<double, 8, 6>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMedianChiSquare = 7.344;  ///< of 8 degrees of freedom
constexpr double kNearest_m = 0.01;
constexpr std::size_t kRefinedStarts = 6;
constexpr double kSamePose_rad = radians(0.5);
constexpr double kPlanar_m = 0.005;

/// A marker of the map as a camera saw it.
struct Sighting {
  CameraProjector<double> projector;
  Pose T_camera_first;  ///< from the first camera's frame, in which poses are, to this one's
  std::size_t camera_index, detection;
  const Marker* marker;
  std::array<Vector2d, 4> corners_px;
  std::array<Vector3d, 4> corners_panel;
  Matrix8d whitener;  ///< makes the corners' errors white, of unit variance
};

std::vector<Sighting> sightingsOf(const std::vector<CameraDetections>& cameras, const PanelMap& map) {
  std::vector<Sighting> sightings;
  for (std::size_t c = 0; c < cameras.size(); ++c)
    for (std::size_t i = 0; i < cameras[c].detections.size(); ++i) {
      const Detection& detection = cameras[c].detections[i];
      const Marker* marker = markerOf(detection, map);
      if (marker == nullptr) continue;
      const auto whitener = lowerWhitener(detection.covariance_px2);
      if (!whitener) continue;
      sightings.push_back({cameras[c].trueProjector(), cameras[c].T_first_camera.inverse(), c, i, marker,
                           detection.corners_px, marker->corners_panel(), *whitener});
    }
  return sightings;
}

/// Corners as predicted minus as seen, px; nothing where one is behind the camera. J: by (p, r), see
/// UncertainPose.
std::optional<Vector8d> reprojection(const Sighting& sighting, const Pose& T_first_panel, Matrix86d* J) {
  using Jet = ceres::Jet<double, 3>;
  const Pose T_camera_panel = sighting.T_camera_first * T_first_panel;
  Vector8d residual;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector3d point = T_camera_panel * sighting.corners_panel[k];
    if (point.z() < kNearest_m) return std::nullopt;
    const auto row = static_cast<Eigen::Index>(2 * k);
    if (J == nullptr) {
      residual.segment<2>(row) = sighting.projector.project(point) - sighting.corners_px[k];
      continue;
    }
    const Vector2<Jet> pixel =
        sighting.projector.project(Vector3<Jet>(Jet(point.x(), 0), Jet(point.y(), 1), Jet(point.z(), 2)));
    residual.segment<2>(row) = Vector2d(pixel.x().a, pixel.y().a) - sighting.corners_px[k];
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << pixel.x().v.transpose(), pixel.y().v.transpose();
    J->block<2, 3>(row, 0) = by_point * sighting.T_camera_first.rotation;
    J->block<2, 3>(row, 3) = -by_point * T_camera_panel.rotation * crossMatrix(sighting.corners_panel[k]);
  }
  return residual;
}

double chiSquareOf(const Sighting& sighting, const Pose& pose) {
  const auto residual = reprojection(sighting, pose, nullptr);
  return residual ? (sighting.whitener * *residual).squaredNorm() : kInfinity;
}

std::vector<double> chiSquaresOf(const std::vector<Sighting>& sightings, const Pose& pose) {
  std::vector<double> values;
  values.reserve(sightings.size());
  for (const Sighting& sighting : sightings) values.push_back(chiSquareOf(sighting, pose));
  return values;
}

Pose moved(const Pose& pose, const Vector6d& step) {
  return {pose.rotation * expSO3<double>(step.tail<3>()), pose.position + step.head<3>()};
}

/// The problem, and the two ways to solve it from a start.
class Solver {
 public:
  Solver(const std::vector<Sighting>& sightings, double gate) : sightings_(sightings), gate_(gate) {}

  struct Minimum {
    Pose pose;
    double cost = kInfinity;
    Matrix6d information = Matrix6d::Zero();
  };

  /// Levenberg-Marquardt. With `robust`, reweighted: each step's scale comes from the median at its start.
  Minimum minimize(const Pose& start, bool robust, int iterations) const {
    Minimum best{start};
    double damping = 1e-4;
    double soft = robust ? softLimit(start) : kInfinity;
    best.cost = cost(start, soft);
    for (int i = 0; i < iterations && std::isfinite(best.cost); ++i) {
      const auto [H, g] = normalEquations(best.pose, soft);
      best.information = H;
      Matrix6d damped = H;
      damped.diagonal() *= 1.0 + damping;
      const Vector6d step = -solveSymmetric(damped, g);
      if (!step.allFinite()) break;
      const Pose trial = moved(best.pose, step);
      const double trial_cost = cost(trial, soft);
      const double gain = best.cost - trial_cost;
      if (gain >= 0) {
        best.pose = trial;
        best.cost = trial_cost;
        damping = std::max(1e-9, damping * 0.1);
        if (robust) best.cost = cost(trial, soft = softLimit(trial));
        if (gain < 1e-9 * (1.0 + best.cost)) break;
      } else {
        damping *= 10.0;
        if (damping > 1e8) break;
      }
    }
    if (std::isfinite(best.cost)) best.information = normalEquations(best.pose, soft).first;
    return best;
  }

  /// Chi-square beyond which a marker is doubted, grown to what the middle marker shows.
  double softLimit(const Pose& pose) const {
    const double median = upperMedian(chiSquaresOf(sightings_, pose));
    return gate_ * std::max(1.0, median / kMedianChiSquare);
  }

  /// Geman-McClure (1985): chi-squares saturate at `soft`.
  double cost(const Pose& pose, double soft) const {
    double sum = 0;
    for (const double value : chiSquaresOf(sightings_, pose)) {
      if (!std::isfinite(value) && !std::isfinite(soft)) return kInfinity;
      sum += !std::isfinite(soft) ? value : (std::isfinite(value) ? value * soft / (value + soft) : soft);
    }
    return sum;
  }

 private:
  std::pair<Matrix6d, Vector6d> normalEquations(const Pose& pose, double soft) const {
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
    for (const Sighting& sighting : sightings_) {
      Matrix86d J;
      const auto residual = reprojection(sighting, pose, &J);
      if (!residual) continue;
      const Vector8d white = sighting.whitener * *residual;
      const Matrix86d white_J = sighting.whitener.lazyProduct(J);
      const double ratio = std::isfinite(soft) ? soft / (soft + white.squaredNorm()) : 1.0;
      H += ratio * ratio * white_J.transpose().lazyProduct(white_J);
      g += ratio * ratio * white_J.transpose().lazyProduct(white);
    }
    return {H, g};
  }

  const std::vector<Sighting>& sightings_;
  double gate_;
};

/// Both planar poses of all corners together that one camera saw, where the markers lie in one plane
/// parallel to the face.
std::vector<Pose> startsFromPlane(const std::vector<Sighting>& sightings, std::size_t camera_index,
                                  const CameraModel& camera) {
  std::vector<Vector2d> points, pixels;
  double z_sum = 0, z_low = kInfinity, z_high = -kInfinity;
  for (const Sighting& sighting : sightings) {
    if (sighting.camera_index != camera_index) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      points.emplace_back(sighting.corners_panel[k].head<2>());
      pixels.push_back(sighting.corners_px[k]);
      z_sum += sighting.corners_panel[k].z();
      z_low = std::min(z_low, sighting.corners_panel[k].z());
      z_high = std::max(z_high, sighting.corners_panel[k].z());
    }
  }
  if (points.empty() || z_high - z_low > kPlanar_m) return {};
  const Vector3d plane(0, 0, z_sum / static_cast<double>(points.size()));
  std::vector<Pose> starts = poseOfPlane(points, pixels, camera);
  for (Pose& pose : starts) pose.position -= pose.rotation * plane;
  return starts;
}

/// From all markers together: good where all are what they seem.
std::vector<Pose> commonStarts(const std::vector<CameraDetections>& cameras,
                               const std::vector<Sighting>& sightings, const PanelPoseOptions& options) {
  std::vector<Pose> starts;
  for (std::size_t c = 0; c < cameras.size(); ++c)
    for (const Pose& T_camera_panel : startsFromPlane(sightings, c, cameras[c].camera))
      starts.push_back(cameras[c].T_first_camera * T_camera_panel);
  if (options.T_camera_panel_guess) starts.push_back(*options.T_camera_panel_guess);
  return starts;
}

/// These, and both poses of every marker alone.
std::vector<Pose> allStarts(std::vector<Pose> starts, const std::vector<CameraDetections>& cameras,
                            const std::vector<Sighting>& sightings) {
  for (const Sighting& sighting : sightings) {
    const CameraDetections& seen = cameras[sighting.camera_index];
    for (const MarkerPose& pose :
         poseOfMarker(seen.detections[sighting.detection], sighting.marker->size_m, seen.camera))
      starts.push_back(seen.T_first_camera * pose.T_camera_marker *
                       sighting.marker->T_panel_marker.inverse());
  }
  return starts;
}

/// The starts that most markers agree with, best first.
std::vector<Pose> bestStarts(std::vector<Pose> starts, const std::vector<Sighting>& sightings) {
  std::vector<std::pair<double, std::size_t>> ranking;
  for (std::size_t i = 0; i < starts.size(); ++i)
    ranking.emplace_back(upperMedian(chiSquaresOf(sightings, starts[i])), i);
  std::sort(ranking.begin(), ranking.end());
  std::vector<Pose> best;
  for (const auto& [value, i] : ranking) {
    if (best.size() == kRefinedStarts || !std::isfinite(value)) break;
    best.push_back(starts[i]);
  }
  return best;
}

Vector3d centreOf(const std::vector<Sighting>& sightings) {
  Vector3d sum = Vector3d::Zero();
  for (const Sighting& sighting : sightings) sum += sighting.marker->T_panel_marker.position;
  return sum / static_cast<double>(sightings.size());
}

/// Where the best of the starts leads to a pose that every marker agrees with, there is nothing to be robust
/// against: that pose. (Its mirror image is tried later, whatever led here.)
std::optional<Pose> poseOfAll(const std::vector<Pose>& starts, const std::vector<Sighting>& sightings,
                              double gate) {
  const auto best = bestStarts(starts, sightings);
  if (best.empty() || sightings.size() < 2) return std::nullopt;
  const auto minimum = Solver(sightings, gate).minimize(best.front(), false, 25);
  const auto values = chiSquaresOf(sightings, minimum.pose);
  const bool all = std::all_of(values.begin(), values.end(), [&](double value) { return value <= gate; });
  return all ? std::optional(minimum.pose) : std::nullopt;
}

/// The robust minimum over all markers.
std::optional<Pose> robustPose(const std::vector<Pose>& starts, const std::vector<Sighting>& sightings,
                               double gate) {
  const Solver solver(sightings, gate);
  std::vector<Pose> minima;
  double soft = kInfinity;  // one for all, so that costs compare
  for (const Pose& start : bestStarts(starts, sightings)) {
    const auto minimum = solver.minimize(start, true, 25);
    if (!std::isfinite(minimum.cost)) continue;
    minima.push_back(minimum.pose);
    soft = std::min(soft, solver.softLimit(minimum.pose));
  }
  if (minima.empty()) return std::nullopt;
  return *std::min_element(minima.begin(), minima.end(), [&](const Pose& a, const Pose& b) {
    return solver.cost(a, soft) < solver.cost(b, soft);
  });
}

std::vector<Sighting> inliersAt(const Pose& pose, const std::vector<Sighting>& sightings, double gate) {
  const double limit = Solver(sightings, gate).softLimit(pose);
  std::vector<Sighting> inliers;
  for (const Sighting& sighting : sightings)
    if (chiSquareOf(sighting, pose) <= limit) inliers.push_back(sighting);
  return inliers;
}

/// Larger than 1 only where chance does not explain the residuals.
double sigmaScale(double chi_square, std::size_t markers) {
  const double freedom = 8.0 * static_cast<double>(markers) - 6.0;
  if (chi_square <= chiSquareQuantile(freedom, 0.99)) return 1.0;
  return std::sqrt(chi_square / freedom);
}

void describeMarkers(const std::vector<Sighting>& sightings, const std::vector<Sighting>& inliers,
                     PanelPoseEstimate& estimate) {
  double squares = 0;
  for (const Sighting& sighting : sightings) {
    const Pose& pose = estimate.T_camera_panel.pose;
    MarkerFit fit;
    fit.camera = sighting.camera_index;
    fit.detection = sighting.detection;
    fit.inlier = std::any_of(inliers.begin(), inliers.end(), [&](const Sighting& inlier) {
      return inlier.camera_index == sighting.camera_index && inlier.detection == sighting.detection;
    });
    const auto residual = reprojection(sighting, pose, nullptr);
    fit.rms_px = residual ? std::sqrt(residual->squaredNorm() / 8.0) : kInfinity;
    fit.chi_square = residual ? (sighting.whitener * *residual).squaredNorm() : kInfinity;
    if (fit.inlier) squares += fit.rms_px * fit.rms_px;
    estimate.markers.push_back(fit);
  }
  estimate.inlier_count = static_cast<int>(inliers.size());
  estimate.rms_px = std::sqrt(squares / static_cast<double>(inliers.size()));
}

PanelPoseEstimate failed(const std::string& why) {
  PanelPoseEstimate estimate;
  estimate.why_not = why;
  return estimate;
}

}  // namespace

PanelPoseEstimate solvePanelPose(const std::vector<Detection>& detections, const PanelMap& map,
                                 const CameraModel& camera, const PanelPoseOptions& options) {
  return solvePanelPose({CameraDetections{detections, camera, {}}}, map, options);
}

PanelPoseEstimate solvePanelPose(const std::vector<CameraDetections>& cameras, const PanelMap& map,
                                 const PanelPoseOptions& options) {
  const auto sightings = sightingsOf(cameras, map);
  if (sightings.empty()) return failed("no marker of the map is seen");
  const double gate = chiSquareQuantile(8, options.inlier_probability);

  const std::vector<Pose> starts = commonStarts(cameras, sightings, options);
  std::optional<Pose> robust = poseOfAll(starts, sightings, gate);
  if (!robust) robust = robustPose(allStarts(starts, cameras, sightings), sightings, gate);
  if (!robust) return failed("no pose explains the corners");

  std::vector<Sighting> inliers = inliersAt(*robust, sightings, gate);
  Solver solver(inliers, gate);
  Solver::Minimum minimum = solver.minimize(*robust, false, 50);
  Solver::Minimum mirrored = solver.minimize(mirrorImage(minimum.pose, centreOf(inliers)), false, 50);
  if (mirrored.cost < minimum.cost) std::swap(minimum, mirrored);
  const SymmetricFactors information(minimum.information);
  const Matrix6d covariance = information.solve(Matrix6d::Identity());
  if (!std::isfinite(minimum.cost) || !covariance.allFinite() || !information.isPositive())
    return failed("the corners do not determine a pose");

  PanelPoseEstimate estimate;
  estimate.solved = true;
  estimate.why_not.clear();
  estimate.sigma_scale = sigmaScale(minimum.cost, inliers.size());
  const double variance_scale = estimate.sigma_scale * estimate.sigma_scale;
  estimate.T_camera_panel = {minimum.pose, variance_scale * covariance};
  const double increase = (mirrored.cost - minimum.cost) / variance_scale;
  if (increase < options.ambiguity_chi_square &&
      angleBetween(minimum.pose.rotation, mirrored.pose.rotation) > kSamePose_rad)
    estimate.alternative = {mirrored.pose, increase};
  describeMarkers(sightings, inliers, estimate);
  return estimate;
}

std::vector<Detection> straightened(const CameraDetections& seen, const PanelMap& map,
                                    const Pose& T_first_panel) {
  const Pose T_camera_panel = seen.T_first_camera.inverse() * T_first_panel;
  const CameraProjector<double> projector = seen.trueProjector();
  std::vector<Detection> straight;
  for (Detection detection : seen.detections) {
    const Marker* marker = markerOf(detection, map);
    if (marker == nullptr) continue;
    const auto corners_panel = marker->corners_panel();
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector3d point = T_camera_panel * corners_panel[k];
      if (point.z() > kNearest_m)
        detection.corners_px[k] += seen.camera.project(point) - projector.project(point);
    }
    straight.push_back(std::move(detection));
  }
  return straight;
}

Pose mirrorImage(const Pose& T_camera_panel, const Vector3d& centre_panel) {
  const Vector3d centre = T_camera_panel * centre_panel, sight = centre.normalized();
  const Vector3d normal = T_camera_panel.rotation.col(2);
  const Vector3d mirrored = 2.0 * sight.dot(normal) * sight - normal;
  const Matrix3d turn = rotationBetween(normal, mirrored);
  Pose result;
  result.rotation = turn * T_camera_panel.rotation;
  result.position = centre - result.rotation * centre_panel;
  return result;
}

UncertainPose robotPose(const UncertainPose& T_camera_panel, const Pose& T_odom_panel,
                        const Pose& T_robot_camera) {
  return T_odom_panel * (T_robot_camera * T_camera_panel).inverse();
}

}  // namespace fathom
