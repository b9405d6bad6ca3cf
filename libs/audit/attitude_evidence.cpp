#include "audit/attitude_evidence.h"

#include "audit/attitude_conventions.h"

namespace fathom {

std::span<const AttitudeReading> attitudeReadings() {
  static const std::array<AttitudeReading, 10> readings{
      {{"", "", [](const Matrix3d& R, const Matrix3d&) { return R; }},
       {"attitude-of-robot", "it is the robot's attitude, not the sensor's",
        [](const Matrix3d& R, const Matrix3d& R_robot_ins) -> Matrix3d { return R * R_robot_ins; }},
       {"attitude-ned", "its world is north-east-down",
        [](const Matrix3d& R, const Matrix3d&) -> Matrix3d { return enuFromNed() * R; }},
       {"attitude-ned-frd", "its axes are north-east-down and forward-right-down",
        [](const Matrix3d& R, const Matrix3d&) -> Matrix3d {
          return enuFromNed() * R * Vector3d(1, -1, -1).asDiagonal();
        }},
       {"attitude-frd", "its axes are forward-right-down",
        [](const Matrix3d& R, const Matrix3d&) -> Matrix3d { return R * Vector3d(1, -1, -1).asDiagonal(); }},
       {"attitude-clockwise", "its heading grows clockwise, as a compass's",
        [](const Matrix3d& R, const Matrix3d&) { return withHeadingReversed(R); }},
       {"attitude-pitch-sign", "its pitch has the other sign",
        [](const Matrix3d& R, const Matrix3d&) { return withPitchReversed(R); }},
       {"attitude-roll-sign", "its roll has the other sign",
        [](const Matrix3d& R, const Matrix3d&) { return withRollReversed(R); }},
       {"attitude-inverse", "it is the inverse: odom in the sensor's axes",
        [](const Matrix3d& R, const Matrix3d&) -> Matrix3d { return R.transpose(); }},
       {"attitude-w-first", "its quaternion's w stands first",
        [](const Matrix3d& R, const Matrix3d&) { return attitudeWFirst(R); }}}};
  return readings;
}

std::array<Regression, 3> turningByAxis(const InsStream& stream) {
  constexpr std::size_t kStep = 10;
  std::array<Regression, 3> axes;
  const auto& w = stream.windows;
  for (std::size_t i = 0; i + kStep < w.size(); i += kStep) {
    if (!w[i].attitude || !w[i + kStep].attitude) continue;
    const double seconds = w[i + kStep].attitude_t_s - w[i].attitude_t_s;
    if (seconds > 2 * static_cast<double>(kStep) * kInsWindow_s) continue;
    Vector3d rate = Vector3d::Zero();
    std::size_t rates = 0;
    for (std::size_t k = i; k < i + kStep; ++k)
      if (w[k].rates > 0) rate += w[k].rate, ++rates;
    if (rates < kStep) continue;
    rate /= static_cast<double>(rates);
    const Vector3d turned = logSO3<double>(w[i].attitude->transpose() * *w[i + kStep].attitude) / seconds;
    for (int k = 0; k < 3; ++k) axes[static_cast<std::size_t>(k)].add(rate[k], turned[k]);
  }
  return axes;
}

}  // namespace fathom
