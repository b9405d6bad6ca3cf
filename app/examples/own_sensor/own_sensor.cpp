// A filter of one's own sensor: ranges to acoustic beacons, which fathom knows nothing of. All that such a
// sensor takes is its equation, written once for any scalar; the filter's Jacobian comes from running it on
// dual numbers.
#include <cstdio>
#include <numbers>
#include <random>

#include "core/chi_square.h"
#include "localization/error_state_filter.h"

namespace {
using namespace fathom;

using Filter =
    ErrorStateFilter<kCoreSize>;  // position, orientation, velocity, angular velocity, acceleration

/// What the sensor reads: the distance from the robot to a beacon, m.
template <class T>
T predictRange(const NavigationState<T>& state, const Vector3d& beacon_odom) {
  return (beacon_odom.cast<T>() - state.motion.position_odom).norm();
}

/// The part of the state that it depends on.
StateColumns position() {
  StateColumns columns;
  for (const int axis : {0, 1, 2}) columns.add(kPosition + axis);
  return columns;
}

Filter::Measurement<1> rangeMeasurement(const NavigationState<double>& state, double range_m,
                                        const Vector3d& beacon_odom, double sigma_m) {
  Filter::Measurement<1> m;
  m.columns = position();
  const auto predicted = predictRange(lift<3>(state, m.columns), beacon_odom);
  m.residual[0] = range_m - predicted.a;
  m.H.leftCols<3>() = predicted.v.transpose();
  m.R(0, 0) = sigma_m * sigma_m;
  return m;
}

/// The robot goes round a circle at constant speed.
Vector3d truePosition(double t_s) {
  const double angle = 2 * std::numbers::pi * t_s / 120.0;
  return {5 * std::cos(angle), 5 * std::sin(angle), -3.0};
}
}  // namespace

int main() {
  constexpr double kStep_s = 0.1, kSigma_m = 0.2;
  const Vector3d beacons[] = {{20, 0, -1}, {-15, 18, -6}, {-12, -20, -2}, {3, 4, -15}};
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, kSigma_m);

  Filter filter;
  filter.x.motion.position_odom = truePosition(0) + Vector3d(2, -1, 1);  // where one believes to start
  filter.P.setZero();
  filter.P.diagonal().segment<3>(kPosition).setConstant(4.0);
  filter.P.diagonal().segment<3>(kVelocity).setConstant(0.25);
  ProcessNoise motion;
  motion.velocity.setConstant(0.01);
  motion.angular_velocity.setZero();
  motion.acceleration.setZero();

  double nis_sum = 0;
  int readings = 0, rejected = 0;
  const double gate = chiSquareQuantile(1, 0.999);
  for (int step = 1; step <= 1200; ++step) {
    const double t_s = step * kStep_s;
    filter.predict(kStep_s, motion);
    const Vector3d& beacon = beacons[step % 4];  // one answers at a time
    const double range_m = (beacon - truePosition(t_s)).norm() + noise(random);
    const Update done = filter.update(rangeMeasurement(filter.x, range_m, beacon, kSigma_m), gate);
    nis_sum += done.nis;
    ++readings;
    if (!done.fused) ++rejected;
  }

  const Vector3d error = filter.x.motion.position_odom - truePosition(120.0);
  const Vector3d sigma = filter.P.diagonal().segment<3>(kPosition).cwiseSqrt();
  std::printf("position error %.3f %.3f %.3f m, sigma %.3f %.3f %.3f m\n", error[0], error[1], error[2],
              sigma[0], sigma[1], sigma[2]);
  std::printf("mean NIS %.2f of %d ranges (1 expected), %d rejected\n", nis_sum / readings, readings,
              rejected);
  const bool is_fine = (error.array().abs() < 4 * sigma.array()).all() && nis_sum / readings < 1.2;
  std::printf("%s\n", is_fine ? "consistent" : "NOT consistent");
  return is_fine ? 0 : 1;
}
