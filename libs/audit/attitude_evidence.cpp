#include "audit/attitude_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "audit/attitude_conventions.h"
#include "core/median.h"

namespace fathom {

std::span<const AttitudeReading> attitudeReadings() {
  static const std::array<AttitudeReading, 6> readings{
      {{"", "", [](const Matrix3d& R, const Matrix3d&) { return R; }},
       {"attitude-of-robot", "it is the robot's attitude, not the sensor's",
        [](const Matrix3d& R, const Matrix3d& R_robot_ins) -> Matrix3d { return R * R_robot_ins; }},
       {"attitude-ned", "its world is north-east-down",
        [](const Matrix3d& R, const Matrix3d&) -> Matrix3d { return enuFromNed() * R; }},
       {"attitude-ned-frd", "its axes are north-east-down and forward-right-down",
        [](const Matrix3d& R, const Matrix3d&) -> Matrix3d {
          return enuFromNed() * R * Vector3d(1, -1, -1).asDiagonal();
        }},
       {"attitude-inverse", "it is the inverse: odom in the sensor's axes",
        [](const Matrix3d& R, const Matrix3d&) -> Matrix3d { return R.transpose(); }},
       {"attitude-w-first", "its quaternion's w stands first",
        [](const Matrix3d& R, const Matrix3d&) { return attitudeWFirst(R); }}}};
  return readings;
}

/// f(mean rate by the gyro, by the attitude), rad/s, over so many windows each.
template <class F>
void AttitudeEvidence::forEachTurn(const AttitudeReading& reading, std::size_t step, F&& f) const {
  const auto& w = stream_.windows;
  for (std::size_t i = 0; i + step < w.size(); i += step) {
    if (!w[i].attitude || !w[i + step].attitude) continue;
    const double seconds = w[i + step].attitude_t_s - w[i].attitude_t_s;
    if (seconds > 2 * static_cast<double>(step) * kInsWindow_s) continue;
    Vector3d rate = Vector3d::Zero();
    std::size_t rates = 0;
    for (std::size_t k = i; k < i + step; ++k)
      if (w[k].rates > 0) rate += w[k].rate, ++rates;
    if (rates < step) continue;
    const auto read = [&](const Matrix3d& R) { return reading.read(R, stream_.T_robot_ins.rotation); };
    f(rate / static_cast<double>(rates),
      logSO3<double>(read(*w[i].attitude).transpose() * read(*w[i + step].attitude)) / seconds);
  }
}

Regression AttitudeEvidence::turning(const AttitudeReading& reading, const Vector3d& gyro_signs) const {
  const Regression soon = turning(reading, 5, gyro_signs);
  return std::abs(soon.correlation()) < 0.7 ? turning(reading, 20, gyro_signs) : soon;
}
Regression AttitudeEvidence::turning(const AttitudeReading& reading, std::size_t windows,
                                     const Vector3d& gyro_signs) const {
  Regression turning;
  forEachTurn(reading, windows, [&](const Vector3d& gyro, const Vector3d& attitude) {
    turning.add(gyro.cwiseProduct(gyro_signs), attitude);
  });
  return turning;
}
std::array<Regression, 3> AttitudeEvidence::turningByAxis(const AttitudeReading& reading) const {
  std::array<Regression, 3> axes;
  forEachTurn(reading, 10, [&](const Vector3d& gyro, const Vector3d& attitude) {
    for (int i = 0; i < 3; ++i) axes[static_cast<std::size_t>(i)].add(gyro[i], attitude[i]);
  });
  return axes;
}

Regression AttitudeEvidence::turningOfGravity() const {
  constexpr std::size_t kHalf = 5;
  Regression turning;
  const auto& w = stream_.windows;
  for (std::size_t i = kHalf; i + 2 * kHalf < w.size(); i += kHalf) {
    if (w[i + kHalf].t_s - w[i - kHalf].t_s > 3 * static_cast<double>(kHalf) * kInsWindow_s) continue;
    Vector3d before = Vector3d::Zero(), behind = Vector3d::Zero(), rate = Vector3d::Zero();
    for (std::size_t k = 0; k < kHalf; ++k) {
      before += w[i - kHalf + k].force, behind += w[i + kHalf + k].force;
      rate += w[i + k].rate / static_cast<double>(kHalf);
    }
    if (before.norm() < 1e-9 || behind.norm() < 1e-9) continue;
    const double seconds = w[i + kHalf].t_s - w[i - kHalf].t_s;
    const Vector3d up = (before + behind).normalized();
    turning.add(up.cross(rate), (behind.normalized() - before.normalized()) / seconds);
  }
  return turning;
}

double AttitudeEvidence::medianTilt(const AttitudeReading& reading, const SignedAxes& force_axes) const {
  std::vector<double> tilts;
  const Matrix3d R_robot_ins = stream_.T_robot_ins.rotation, axes = force_axes.matrix();
  for (std::size_t i = 0; i + 4 < stream_.windows.size(); i += 5) {
    Vector3d force = Vector3d::Zero();
    for (std::size_t k = i; k < i + 5; ++k) force += stream_.windows[k].force;
    const InsWindow& middle = stream_.windows[i + 2];
    if (!middle.attitude || force.norm() < 1e-9) continue;
    const Vector3d up = reading.read(*middle.attitude, R_robot_ins) * axes * force.normalized();
    tilts.push_back(std::acos(std::clamp(up.z(), -1.0, 1.0)));
  }
  return tilts.size() < kFewestSeconds ? std::numeric_limits<double>::quiet_NaN() : upperMedian(tilts);
}

}  // namespace fathom
