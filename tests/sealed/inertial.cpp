#include "inertial.h"

#include <cmath>

#include "streams.h"

namespace fathom::sealed {

void WanderingBias::step(double seconds, Random& random) {
  const double kept = std::exp(-seconds / time_constant_s_);
  value_ = kept * value_ + sigma_ * std::sqrt(1 - kept * kept) * random.normal3();
}

InertialUnit::InertialUnit(const Vehicle& vehicle, const SealedCase& sealed, const Dive& dive)
    : vehicle_(vehicle),
      sealed_(sealed),
      dive_(dive),
      random_(stream(sealed.seed, Stream::ins)),
      gyro_bias_(vehicle.ins.gyro_bias_sigma_rad_s, vehicle.ins.bias_time_constant_s, random_),
      accelerometer_bias_(vehicle.ins.accelerometer_bias_sigma_m_s2, vehicle.ins.bias_time_constant_s,
                          random_) {}

/// What gyro and accelerometer feel at one instant: a turning Earth adds its rate, and Coriolis' acceleration
/// to what holds the vehicle up (Groves 2013, eqs. 5.13 and 5.53).
InertialUnit::Felt InertialUnit::feltAt(double t_s, double stamp_s) const {
  const Motion motion = dive_.at(t_s);
  const Pose T_robot_ins = vehicle_.ins.pose.pose();
  const Matrix3d R_ins_robot =
      (T_robot_ins.rotation * sealed_.rotation("ins-misalignment", "rotation_deg", stamp_s)).transpose();
  const Matrix3d R_robot_odom = motion.T_odom_robot.rotation.transpose();
  const Vector3d earth_rate_odom = sealed_.vector("earth-rotation", "rate_rad_s", stamp_s);
  const Vector3d held_up_odom =
      Vector3d(0, 0, vehicle_.gravity_m_s2) + 2 * earth_rate_odom.cross(motion.velocity_odom);

  const Vector3d force_robot = motion.accelerationOf(T_robot_ins.position) + R_robot_odom * held_up_odom;
  const Vector3d rate_robot = motion.rate_robot + R_robot_odom * earth_rate_odom;
  return {R_ins_robot * rate_robot, R_ins_robot * force_robot};
}

/// Gauss and Legendre's three nodes: exact to the interval's sixth power.
InertialUnit::Felt InertialUnit::meanAround(double t_s, double stamp_s) const {
  const double half_s = 0.5 / vehicle_.ins.rate_hz, node = std::sqrt(0.6);
  const Felt before = feltAt(t_s - node * half_s, stamp_s), middle = feltAt(t_s, stamp_s),
             behind = feltAt(t_s + node * half_s, stamp_s);
  return {(5 * before.rate_ins + 8 * middle.rate_ins + 5 * behind.rate_ins) / 18,
          (5 * before.force_ins + 8 * middle.force_ins + 5 * behind.force_ins) / 18};
}

InsSample InertialUnit::read(double t_s) {
  const Felt felt = meanAround(
      sealed_.trueTime_s(labels::kIns, t_s) - sealed_.number("ins-latency", "latency_s", t_s), t_s);
  Vector3d rate_ins = felt.rate_ins * (1 + sealed_.number("gyro-scale", "scale_error", t_s)) +
                      sealed_.vector("gyro-bias", "bias_rad_s", t_s) +
                      sealed_.outsideSize("gyro-g-sensitivity") * felt.force_ins;
  Vector3d force_ins = felt.force_ins + sealed_.vector("accelerometer-bias", "bias_m_s2", t_s);
  if (sealed_.noise) {
    rate_ins += gyro_bias_.value() + vehicle_.ins.gyro_sigma_rad_s * random_.normal3();
    force_ins += accelerometer_bias_.value() + vehicle_.ins.accelerometer_sigma_m_s2 * random_.normal3();
    gyro_bias_.step(1 / vehicle_.ins.rate_hz, random_);
    accelerometer_bias_.step(1 / vehicle_.ins.rate_hz, random_);
  }
  return {vehicle_.ins.pose.pose(), rate_ins, force_ins, {}};
}

}  // namespace fathom::sealed
