#include "audit/acceleration_evidence.h"

#include <Eigen/QR>
#include <algorithm>
#include <limits>

namespace fathom {
namespace {

constexpr double kSegment_s = 8;
constexpr std::size_t kFewestReadings = 10;  // in a segment

/// One segment: what was integrated so far, from its beginning.
class Segment {
 public:
  explicit Segment(double from_s) : t_s_(from_s) {}

  void integrate(double to_s, const Vector3d& rate_robot, const Vector3d& force_robot) {
    const double seconds = to_s - t_s_;
    const Matrix3d half = expSO3<double>(0.5 * seconds * rate_robot), middle = turned_ * half;
    const Vector3d change = middle * force_robot * seconds;
    velocity_ += change;
    velocity_by_gyro_ -= crossMatrix<double>(change) * (turning_ + 0.5 * seconds * middle);
    turning_ += seconds * middle;
    turned_ = middle * half;
    t_s_ = to_s;
  }
  /// `swing_robot`: of the DVL about the INS, as the robot turns.
  void read(double t_s, const Vector3d& velocity_robot, const Vector3d& swing_robot) {
    times_.push_back(t_s);
    by_ins_.emplace_back(velocity_ + turned_ * swing_robot);
    by_dvl_.emplace_back(turned_ * velocity_robot);
    // A gyro's bias turns both velocities, an accelerometer's adds to the INS's.
    AccelerationEvidence::ByBias& by_bias = by_bias_.emplace_back();
    by_bias << -crossMatrix<double>(by_dvl_.back() - turned_ * swing_robot) * turning_ - velocity_by_gyro_,
        -turning_;
  }

  void finish(std::vector<AccelerationEvidence::Change>& changes) const {
    const auto n = static_cast<Eigen::Index>(times_.size());
    if (times_.size() < kFewestReadings) return;
    Eigen::MatrixXd parabola(n, 3), both(n, 24);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double t = times_[k] - times_.front();
      parabola.row(i) << 1, t, t * t;
      both.row(i) << by_ins_[k].transpose(), by_dvl_[k].transpose(), by_bias_[k].reshaped().transpose();
    }
    const Eigen::MatrixXd left = both - parabola * parabola.householderQr().solve(both);
    for (Eigen::Index i = 0; i < n; ++i)
      changes.push_back({left.row(i).head<3>().transpose(), left.row(i).segment<3>(3).transpose(),
                         left.row(i).tail<18>().reshaped(3, 6)});
  }

 private:
  double t_s_;
  Matrix3d turned_ = Matrix3d::Identity();
  Vector3d velocity_ = Vector3d::Zero();
  Matrix3d turning_ = Matrix3d::Zero(),  // integral of turned_: by a bias of a unit
      velocity_by_gyro_ = Matrix3d::Zero();
  std::vector<double> times_;
  std::vector<AccelerationEvidence::ByBias> by_bias_;
  std::vector<Vector3d> by_ins_, by_dvl_;
};

}  // namespace

Regression AccelerationEvidence::all(const Eigen::Matrix<double, 6, 1>& bias) const {
  Regression r;
  for (const Change& c : changes) r.add(c.by_ins + c.by_bias * bias, c.by_dvl);
  return r;
}

AccelerationEvidence accelerationEvidence(const DvlStream& dvl, const InsStream& ins,
                                          const AssumedAxes& axes) {
  AccelerationEvidence evidence;
  if (ins.windows.empty()) return evidence;
  const Matrix3d gyro = ins.T_robot_ins.rotation * axes.gyro,
                 force = ins.T_robot_ins.rotation * axes.accelerometer,
                 R_dvl = dvl.T_robot_dvl.rotation * axes.dvl;
  const double later_s = axes.dvl_later_s, whole_s = ins.windows.back().t_s - ins.windows.front().t_s;
  const double stride_s = std::max(kSegment_s, whole_s / static_cast<double>(kMostSegments));
  double skip_to_s = -std::numeric_limits<double>::infinity();
  const Vector3d lever = dvl.T_robot_dvl.position - ins.T_robot_ins.position;
  std::size_t next = 0;
  std::optional<Segment> segment;
  double from_s = 0, before_s = 0;
  for (const InsWindow& w : ins.windows) {
    const double to_s = w.t_s + kInsWindow_s / 2;
    const bool whole = w.rates > 0 && w.forces > 0 && to_s - before_s < 3 * kInsWindow_s;
    if (segment && (!whole || w.t_s - from_s > kSegment_s)) {
      segment->finish(evidence.changes);
      segment.reset();
    }
    if (!segment) {
      if (w.t_s < skip_to_s) {
        before_s = to_s;
        continue;
      }
      skip_to_s = w.t_s + stride_s;
      from_s = w.t_s - kInsWindow_s / 2;
      segment.emplace(from_s);
      while (next < dvl.velocities.size() && dvl.velocities[next].t_s + later_s < from_s) ++next;
    }
    for (; next < dvl.velocities.size() && dvl.velocities[next].t_s + later_s < to_s; ++next) {
      const double t_s = dvl.velocities[next].t_s + later_s;
      const Vector3d& velocity = dvl.velocities[next].value;
      segment->integrate(t_s, gyro * w.rate, force * w.force);
      segment->read(t_s, R_dvl * velocity, (gyro * w.rate).cross(lever));
    }
    segment->integrate(to_s, gyro * w.rate, force * w.force);
    before_s = to_s;
  }
  if (segment) segment->finish(evidence.changes);
  return evidence;
}

}  // namespace fathom
