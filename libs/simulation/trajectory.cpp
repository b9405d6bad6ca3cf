#include "simulation/trajectory.h"

#include <algorithm>
#include <array>
#include <span>

#include "core/error.h"

namespace fathom {
namespace {

/// Of the segment from knot i+2 on, at a time.
SplineWeights<double> weightsAt(const std::vector<double>& knots, std::size_t i, double t_s) {
  return {std::span(knots).subspan(i).first<6>(), t_s};
}

/// Two mirrored knots beyond each end, so that every segment has its six.
std::vector<double> withOuterKnots(const std::vector<double>& times_s) {
  const auto& t = times_s;
  const std::size_t n = t.size();
  std::vector<double> knots{2 * t[0] - t[2], 2 * t[0] - t[1]};
  knots.insert(knots.end(), t.begin(), t.end());
  knots.push_back(2 * t[n - 1] - t[n - 2]);
  knots.push_back(2 * t[n - 1] - t[n - 3]);
  return knots;
}

void checkPoses(const std::vector<double>& times_s, const std::vector<Pose>& poses, const std::string& name) {
  if (times_s.size() != poses.size()) throw Error(name, "", "as many times as poses are needed");
  if (times_s.size() < 4)
    throw Error(name, "", "a trajectory needs at least 4 poses, has " + std::to_string(times_s.size()));
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    const std::string where = "pose " + std::to_string(i + 1);
    const double interval = times_s[i] - times_s[i - 1];
    if (!(interval > 0)) throw Error(name, where, "times must increase");
    if (i > 1) {
      const double before = times_s[i - 1] - times_s[i - 2];
      if (std::max(interval / before, before / interval) > Trajectory::kMaxIntervalRatio)
        throw Error(name, where,
                    "time stamps are too uneven to interpolate: " + std::to_string(interval) + " s after " +
                        std::to_string(before) + " s");
    }
    if (angleBetween(poses[i - 1].rotation, poses[i].rotation) > Trajectory::kMaxTurn)
      throw Error(name, where, "turns by more than 2 rad since the pose before: give poses in between");
  }
}

/// The linear equations of interpolation: row i holds what control points i-1, i, i+1 weigh at time i. Below
/// the first and above the last stands the natural end: a second derivative of zero. Solved by the Thomas
/// algorithm after each end row has been used to eliminate the outermost control point.
class InterpolationEquations {
 public:
  explicit InterpolationEquations(const std::vector<double>& knots) : rows_(knots.size() - 4) {
    const std::size_t n = rows_.size();
    for (std::size_t i = 0; i < n; ++i) rows_[i] = valueRow(knots, i);
    start_ = curvatureRow(knots, 0);
    end_ = curvatureRow(knots, n - 1);
    eliminate(rows_.front(), start_, 0);
    eliminate(rows_.back(), end_, 2);
    for (std::size_t i = 1; i < n; ++i) rows_[i][1] -= rows_[i][0] / rows_[i - 1][1] * rows_[i - 1][2];
  }

  /// right[0] and right[n+1] belong to the natural ends, right[i+1] to time i. Solved in place.
  void solve(std::vector<Vector3d>& right) const {
    const std::size_t n = rows_.size();
    right[1] -= first_factor_ * right[0];
    right[n] -= last_factor_ * right[n + 1];
    for (std::size_t i = 1; i < n; ++i) right[i + 1] -= rows_[i][0] / rows_[i - 1][1] * right[i];
    right[n] /= rows_[n - 1][1];
    for (std::size_t i = n - 1; i > 0; --i)
      right[i] = (right[i] - rows_[i - 1][2] * right[i + 1]) / rows_[i - 1][1];
    right[0] = (right[0] - start_[1] * right[1] - start_[2] * right[2]) / start_[0];
    right[n + 1] = (right[n + 1] - end_[0] * right[n - 1] - end_[1] * right[n]) / end_[2];
  }

 private:
  using Row = std::array<double, 3>;

  /// At the left knot of a segment the fourth basis function is zero, at the right one the first.
  static Row valueRow(const std::vector<double>& knots, std::size_t i) {
    const bool last = i + 5 == knots.size();
    const auto w = weightsAt(knots, last ? i - 1 : i, knots[i + 2]);
    if (last) return {w.value[0] - w.value[1], w.value[1] - w.value[2], w.value[2]};
    return {1.0 - w.value[0], w.value[0] - w.value[1], w.value[1] - w.value[2]};
  }
  static Row curvatureRow(const std::vector<double>& knots, std::size_t i) {
    const bool last = i > 0;
    const auto w = weightsAt(knots, last ? i - 1 : i, knots[i + 2]);
    if (last) return {w.curvature[0] - w.curvature[1], w.curvature[1] - w.curvature[2], w.curvature[2]};
    return {-w.curvature[0], w.curvature[0] - w.curvature[1], w.curvature[1] - w.curvature[2]};
  }
  void eliminate(Row& row, const Row& with, std::size_t column) {
    const double factor = row[column] / with[column];
    (column == 0 ? first_factor_ : last_factor_) = factor;
    for (std::size_t j = 0; j < 3; ++j) row[j] -= factor * with[j];
  }

  std::vector<Row> rows_;
  Row start_{}, end_{};
  double first_factor_ = 0, last_factor_ = 0;
};

}  // namespace

Trajectory::Trajectory(const std::vector<double>& times_s, const std::vector<Pose>& T_odom_robot,
                       const std::string& name) {
  checkPoses(times_s, T_odom_robot, name);
  knots_ = withOuterKnots(times_s);
  solveControlPoints(T_odom_robot, name);
}

Trajectory Trajectory::fromTum(const std::vector<StampedPose>& poses, const std::string& name) {
  std::vector<double> times_s;
  std::vector<Pose> T_odom_robot;
  for (const StampedPose& pose : poses) {
    times_s.push_back(secondsBetween(poses.front().time, pose.time));
    T_odom_robot.push_back(pose.T_odom_robot);
  }
  return {times_s, T_odom_robot, name};
}

std::size_t Trajectory::segmentAt(double time_s) const {
  const auto after = std::upper_bound(knots_.begin() + 3, knots_.end() - 3, time_s);
  return static_cast<std::size_t>(after - knots_.begin()) - 3;
}

/// Positions are linear in their control points; rotations nearly so: the same equations, solved for what is
/// still missing, converge in a few rounds (each gains a factor of about the turn between neighbours, rad).
void Trajectory::solveControlPoints(const std::vector<Pose>& T_odom_robot, const std::string& name) {
  const std::size_t n = T_odom_robot.size();
  const InterpolationEquations equations(knots_);
  std::vector<Vector3d> step(n + 2, Vector3d::Zero());
  for (std::size_t i = 0; i < n; ++i) step[i + 1] = T_odom_robot[i].position;
  equations.solve(step);

  T_odom_control_.assign(n + 2, T_odom_robot.front());
  std::copy(T_odom_robot.begin(), T_odom_robot.end(), T_odom_control_.begin() + 1);
  T_odom_control_.back() = T_odom_robot.back();
  for (std::size_t i = 0; i < n + 2; ++i) T_odom_control_[i].position = step[i];

  constexpr int kMaxRounds = 100;
  constexpr double kTolerance_rad = 1e-12;
  for (int round = 0; round < kMaxRounds; ++round) {
    turn_.clear();
    for (std::size_t i = 0; i + 1 < n + 2; ++i)
      turn_.push_back(
          logSO3<double>(T_odom_control_[i].rotation.transpose() * T_odom_control_[i + 1].rotation));
    double missing = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const KinematicState<double> state = at(knots_[i + 2]);
      step[i + 1] = logSO3<double>(state.R_odom_robot.transpose() * T_odom_robot[i].rotation);
      missing = std::max(missing, step[i + 1].norm());
      if (i == 0) step[0] = -state.angular_acceleration_robot;
      if (i == n - 1) step[n + 1] = -state.angular_acceleration_robot;
    }
    if (round > 0 && missing < kTolerance_rad) return;
    equations.solve(step);
    for (std::size_t i = 0; i < n + 2; ++i)
      T_odom_control_[i].rotation = T_odom_control_[i].rotation * expSO3<double>(step[i]);
  }
  throw Error(name, "", "turns too fast between its poses to interpolate");
}

}  // namespace fathom
