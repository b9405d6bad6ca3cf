#include "localization/evaluation.h"

#include <algorithm>
#include <limits>

#include "core/linear_algebra.h"

namespace fathom {
namespace {

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

MeanAndSigma meanAndSigma(const std::vector<double>& values) {
  const double n = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  for (const double value : values) squares += (value - sum / n) * (value - sum / n);
  return {sum / n, values.size() > 1 ? std::sqrt(squares / (n - 1.0)) : 0.0};
}

bool Evaluator::add(const Estimate& estimate) {
  auto truth = poseAt(reference_, estimate.time);
  if (!truth) return false;
  const KinematicState<double>& m = estimate.state.motion;
  if (estimate.defined.any()) {
    if (!T_defined_reference_)
      T_defined_reference_ = moveTo({m.R_odom_robot, m.position_odom}, *truth, estimate.defined).T_new_old;
    truth = *T_defined_reference_ * *truth;
  }
  PoseError error;
  error.t_s = estimate.t_s;
  error.position_m = m.position_odom - truth->position;
  error.rotation_rad = logSO3<double>(truth->rotation.transpose() * m.R_odom_robot);
  const Eigen::Matrix<double, 6, 1> sigma = estimate.pose_covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  error.position_sigma_m = sigma.head<3>();
  error.rotation_sigma_rad = sigma.tail<3>();
  Eigen::Matrix<double, 6, 1> e;
  e << error.position_m, error.rotation_rad;
  error.nees = normalizedSquare(estimate.pose_covariance, e);
  errors_.push_back(error);
  return true;
}

std::optional<Evaluation> Evaluator::finish() const {
  if (errors_.empty()) return std::nullopt;
  Evaluation result;
  result.errors = errors_;
  result.is_laid = T_defined_reference_.has_value();
  std::vector<double> positions, angles, nees;
  double inside = 0.0;
  for (const PoseError& error : errors_) {
    positions.push_back(error.position_m.norm());
    angles.push_back(error.rotation_rad.norm());
    nees.push_back(error.nees);
    for (int axis = 0; axis < 3; ++axis) {
      inside += std::abs(error.position_m[axis]) <= 3.0 * error.position_sigma_m[axis];
      inside += std::abs(error.rotation_rad[axis]) <= 3.0 * error.rotation_sigma_rad[axis];
    }
  }
  result.position_m = meanAndSigma(positions);
  result.angle_rad = meanAndSigma(angles);
  result.position_rms_m = rms(positions);
  result.angle_rms_rad = rms(angles);
  result.nees_mean = meanAndSigma(nees).mean;
  result.within_3_sigma = inside / (6.0 * static_cast<double>(errors_.size()));
  for (std::size_t i = 1; i < reference_.size(); ++i)
    result.path_m += (reference_[i].T_odom_robot.position - reference_[i - 1].T_odom_robot.position).norm();
  return result;
}

double positionErrorAt(const std::vector<PoseError>& errors, double t_s) {
  const auto next = std::upper_bound(errors.begin(), errors.end(), t_s,
                                     [](double t, const PoseError& error) { return t < error.t_s; });
  if (next == errors.begin() || t_s - std::prev(next)->t_s > 2.0)
    return std::numeric_limits<double>::quiet_NaN();
  return std::prev(next)->position_m.norm();
}

}  // namespace fathom
