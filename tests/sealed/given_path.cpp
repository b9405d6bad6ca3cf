#include "given_path.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "recording/tum.h"

namespace fathom::sealed {
namespace {

constexpr double kLargestGap_s = 0.1 + 1e-6, kLargestTurn_rad = 0.5;

using Coordinates = Eigen::Matrix<double, 7, 1>;

/// Of the two quaternions that are this rotation the one nearer to `before`.
Coordinates coordinatesOf(const Pose& pose, const Coordinates& before) {
  Eigen::Quaterniond q(pose.rotation);
  if (q.coeffs().dot(before.tail<4>()) < 0) q.coeffs() = -q.coeffs();
  Coordinates c;
  c << pose.position, q.coeffs();
  return c;
}

/// Second derivatives of the natural cubic spline: a tridiagonal system, by elimination (de Boor 1978).
std::vector<Coordinates> curvaturesOf(const std::vector<double>& t, const std::vector<Coordinates>& y) {
  std::vector<Coordinates> curvature(t.size(), Coordinates::Zero());
  std::vector<double> above(t.size(), 0.0);
  for (std::size_t i = 1; i + 1 < t.size(); ++i) {
    const double before = t[i] - t[i - 1], after = t[i + 1] - t[i];
    const double pivot = 2 * (before + after) - before * above[i - 1];
    above[i] = after / pivot;
    const Coordinates bend = 6 * ((y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before);
    curvature[i] = (bend - before * curvature[i - 1]) / pivot;
  }
  for (std::size_t i = t.size() - 1; i-- > 1;) curvature[i] -= above[i] * curvature[i + 1];
  return curvature;
}

Eigen::Quaterniond quaternionOf(const Coordinates& c) { return Eigen::Quaterniond(c[6], c[3], c[4], c[5]); }

/// Turning by a quaternion of any length and its derivatives: the rate is the vector of 2 q^-1 q'.
void turn(const Coordinates& value, const Coordinates& rate, const Coordinates& acceleration,
          Motion& motion) {
  const Eigen::Quaterniond inverse = quaternionOf(value).inverse();
  const Eigen::Quaterniond u = inverse * quaternionOf(rate);
  motion.T_odom_robot.rotation = quaternionOf(value).normalized().toRotationMatrix();
  motion.rate_robot = 2 * u.vec();
  motion.angular_acceleration_robot = 2 * ((inverse * quaternionOf(acceleration)).vec() - (u * u).vec());
}

}  // namespace

GivenPath::GivenPath(const std::filesystem::path& file, double duration_s) {
  for (const StampedPose& stamped : readTum(file)) {
    const double t_s = secondsBetween(fromUnixSeconds(0), stamped.time);
    const Coordinates before = values_.empty() ? Coordinates(Coordinates::Unit(6)) : values_.back();
    const Coordinates here = coordinatesOf(stamped.T_odom_robot, before);
    const auto error = [&](const char* why) { return Error(file.string(), print("%g s", t_s), why); };
    if (!times_s_.empty() && t_s - times_s_.back() > kLargestGap_s)
      throw error("is more than 0.1 s after the pose before");
    if (!times_s_.empty() && quaternionOf(here).angularDistance(quaternionOf(before)) > kLargestTurn_rad)
      throw error("is turned by more than half a radian from the pose before");
    times_s_.push_back(t_s);
    values_.push_back(here);
  }
  if (times_s_.front() > 0 || times_s_.back() < duration_s)
    throw Error(file.string(), "", print("must reach from 0 to %g s", duration_s));
  curvatures_ = curvaturesOf(times_s_, values_);
}

Motion GivenPath::at(double t_s) const {
  const double within_s = std::clamp(t_s, times_s_.front(), times_s_.back());
  const auto after = std::upper_bound(times_s_.begin() + 1, times_s_.end() - 1, within_s);
  const auto i = static_cast<std::size_t>(after - times_s_.begin());
  const double h = times_s_[i] - times_s_[i - 1], b = (within_s - times_s_[i - 1]) / h, a = 1 - b;
  const Coordinates &y0 = values_[i - 1], &y1 = values_[i], &c0 = curvatures_[i - 1], &c1 = curvatures_[i];
  const Coordinates value = a * y0 + b * y1 + h * h / 6 * ((a * a * a - a) * c0 + (b * b * b - b) * c1);
  const bool rests = within_s != t_s;
  const Coordinates rate =
      rests ? Coordinates(Coordinates::Zero())
            : Coordinates((y1 - y0) / h + h / 6 * ((3 * b * b - 1) * c1 - (3 * a * a - 1) * c0));
  const Coordinates acceleration = rests ? Coordinates(Coordinates::Zero()) : Coordinates(a * c0 + b * c1);
  Motion motion;
  motion.T_odom_robot.position = value.head<3>();
  motion.velocity_odom = rate.head<3>();
  motion.acceleration_odom = acceleration.head<3>();
  turn(value, rate, acceleration, motion);
  return motion;
}

}  // namespace fathom::sealed
