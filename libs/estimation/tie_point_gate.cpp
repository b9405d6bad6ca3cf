#include "estimation/tie_point_gate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/linear_algebra.h"
#include "core/median.h"
#include "estimation/readings.h"

namespace fathom {
namespace {

/// What they scatter by, but for a few that are far off; at least as stated.
double scatterOf(const Eigen::VectorXd& left) {
  const Eigen::VectorXd absolute = left.cwiseAbs();
  return std::max(1.0, sigmaByMedian({absolute.begin(), absolute.end()}));
}

/// What pairs of nominal cameras contradict themselves by, in sigmas of the scatter: the right one moved to
/// where most agree (least squares, what is far off weighted down again and again), no farther than its
/// mounting is uncertain. Not finite where lines of sight are parallel.
Eigen::VectorXd contradictionsOf(const std::vector<BatchTiePoint>& points, const CameraSheet& sheet) {
  constexpr int kRounds = 20;
  constexpr double kRobust = 1.5;  // Huber's, in sigmas
  std::vector<int> columns(6);
  std::iota(columns.begin(), columns.end(), kRightColumn);
  Eigen::VectorXd nominal(std::ssize(points));
  Eigen::MatrixXd J(std::ssize(points), 6), row;
  std::vector<Eigen::Index> meeting;
  for (Eigen::Index i = 0; i < nominal.size(); ++i) {
    const BatchTiePoint& seen = points[static_cast<std::size_t>(i)];
    ForwardPoint at;
    at.T_left_right = seen.T_left_right;
    nominal[i] = tiePointModel(seen)->differentiate(at, columns, row)[0];
    J.row(i) = row;
    if (std::isfinite(nominal[i]) && row.allFinite()) meeting.push_back(i);
  }
  Eigen::VectorXd sizes = Eigen::VectorXd::Constant(nominal.size(), std::numeric_limits<double>::quiet_NaN());
  if (meeting.empty()) return sizes;
  nominal = nominal(meeting).eval();
  J = J(meeting, Eigen::all).eval();
  Vector6d prior;
  prior << Vector3d::Constant(sheet.right_position_sigma_m), Vector3d::Constant(sheet.right_angle_sigma_rad);
  Eigen::VectorXd left = nominal;
  for (int round = 0; round < kRounds; ++round) {
    const double sigma = scatterOf(left);
    const Eigen::ArrayXd weight = (kRobust * sigma / left.array().abs()).min(1.0) / (sigma * sigma);
    Matrix6d normal = J.transpose() * weight.matrix().asDiagonal() * J;
    normal.diagonal() += prior.cwiseAbs2().cwiseInverse();
    const Vector6d moved = -solveSymmetric(normal, J.transpose() * (weight * nominal.array()).matrix());
    left = nominal + J * moved;
  }
  sizes(meeting) = left / scatterOf(left);
  return sizes;
}

}  // namespace

void leaveOutMismatches(BatchData& data) {
  constexpr double kMismatch = 8;  // sigmas of the scatter shown: more than an effect that is left out makes
  if (data.tie_points.empty()) return;
  const Eigen::VectorXd sizes =
      contradictionsOf(data.tie_points, data.vehicle.camera.value_or(CameraSheet{}));
  std::vector<BatchTiePoint> kept;
  for (std::size_t i = 0; i < data.tie_points.size(); ++i)
    if (std::abs(sizes[static_cast<Eigen::Index>(i)]) <= kMismatch) kept.push_back(data.tie_points[i]);
  if (kept.size() < data.tie_points.size())
    data.left_out["tie points of two different things"] = data.tie_points.size() - kept.size();
  data.tie_points = std::move(kept);
}

}  // namespace fathom
