#include "localization/alignment.h"

#include "localization/measurements.h"
#include "sensors/models.h"

namespace fathom {
namespace {

/// A running mean that knows whether there is one.
struct Mean {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  void add(const Vector3d& value) {
    if (!value.allFinite()) return;
    sum += value;
    ++count;
  }
  bool any() const { return count > 0; }
  Vector3d value() const { return sum / count; }
};

/// What the first seconds say, in robot axes.
struct FirstReadings {
  Mean specific_force, rate, velocity, usbl, floor_depth;
  Mean depth_z;  ///< z only: height of the robot if it were level
  std::optional<Matrix3d> R_odom_robot;
};

/// How the sensor truly sits.
template <Sensor S>
Matrix3d mountedAt(const Pose& nominal, const LocalizationSetup& setup, const Sample& sample) {
  const double t_s = secondsBetween(setup.time_zero, sample.time);
  return sensorMounting<S>(nominal, setup.calibration, t_s).R_robot_sensor;
}

void read(const InsSample& s, const Matrix3d& R, FirstReadings& first) {
  if (s.specific_force_ins) first.specific_force.add(R * *s.specific_force_ins);
  if (s.angular_velocity_ins) first.rate.add(R * *s.angular_velocity_ins);
  if (s.R_odom_ins && !first.R_odom_robot && s.R_odom_ins->allFinite())
    first.R_odom_robot = *s.R_odom_ins * R.transpose();
}

void read(const DvlSample& s, const Matrix3d& R, FirstReadings& first) {
  if (s.velocity_dvl && first.velocity.count == 0) first.velocity.add(R * *s.velocity_dvl);
}

/// Height of the robot if it were level: pressure is linear in it.
double height_m(const DepthSample& depth, double t_s, const LocalizationSetup& setup) {
  const auto pressureAt = [&](double z) {
    KinematicState<double> level;
    level.position_odom.z() = z;
    return predictPressure(level, World<double>{setup.vehicle.gravityOdom()}, *setup.vehicle.depth,
                           depth.T_robot_depth, setup.calibration, t_s);
  };
  const double at_surface = pressureAt(0), a_metre_below = pressureAt(-1);
  return (at_surface - depth.pressure_pa) / (a_metre_below - at_surface);
}

FirstReadings readAll(const LocalizationSetup& setup, const std::vector<Sample>& samples) {
  FirstReadings first;
  for (const Sample& sample : samples) {
    if (const auto* ins = std::get_if<InsSample>(&sample.reading))
      read(*ins, mountedAt<Sensor::ins>(ins->T_robot_ins, setup, sample), first);
    if (const auto* dvl = std::get_if<DvlSample>(&sample.reading))
      read(*dvl, mountedAt<Sensor::dvl>(dvl->T_robot_dvl, setup, sample), first);
    if (const auto* depth = std::get_if<DepthSample>(&sample.reading); depth && setup.vehicle.depth)
      first.depth_z.add({0, 0, height_m(*depth, secondsBetween(setup.time_zero, sample.time), setup)});
    if (const auto* pose = std::get_if<PoseSample>(&sample.reading); pose && sample.label == labels::kUsbl)
      first.usbl.add(Pose::fromMrpt(pose->T_odom_robot.mean).position);
    if (const auto* beams = std::get_if<DvlBeamsSample>(&sample.reading)) {
      for (const DvlBeam& beam : beams->beams)
        if (beam.range_m) first.floor_depth.add(beam.T_robot_beam * Vector3d(*beam.range_m, 0, 0));
    }
  }
  return first;
}

/// Roll and pitch that turn the mean specific force upright; yaw zero.
Matrix3d level(const Vector3d& specific_force_robot) {
  const Vector3d up = specific_force_robot.normalized();
  return rotationFromYawPitchRoll(0, std::atan2(-up.x(), std::hypot(up.y(), up.z())),
                                  std::atan2(up.y(), up.z()));
}

void alignOrientation(const LocalizationSetup& setup, const FirstReadings& first, InitialState& initial) {
  auto& motion = initial.state.motion;
  double tilt_sigma = radians(0.5), yaw_sigma = radians(0.5);
  if (setup.start) {
    motion.R_odom_robot = setup.start->T_odom_robot.rotation;
    tilt_sigma = yaw_sigma = setup.start->angle_sigma_rad;
    initial.source = "pose: " + setup.start->source;
  } else if (first.R_odom_robot) {
    motion.R_odom_robot = *first.R_odom_robot;
    if (setup.vehicle.ins && setup.vehicle.ins->attitude_sigma_rad)
      tilt_sigma = yaw_sigma = std::max(*setup.vehicle.ins->attitude_sigma_rad, radians(0.05));
    initial.source = "orientation: INS attitude";
  } else if (first.specific_force.any()) {
    // Leveled while the vehicle may accelerate by some 0.1 m/s²; heading zero defines odom's x axis.
    motion.R_odom_robot = level(first.specific_force.value());
    tilt_sigma = radians(1.0);
    yaw_sigma = radians(0.01);
    initial.source = "orientation: leveled by gravity, heading zero by definition";
  } else {
    tilt_sigma = radians(5.0);
    yaw_sigma = radians(0.01);
    initial.source = "orientation: assumed level, heading zero by definition";
  }
  initial.sigma.segment<3>(kOrientation) << tilt_sigma, tilt_sigma, yaw_sigma;
}

/// The orientation must be known.
void alignPosition(const LocalizationSetup& setup, const FirstReadings& first, InitialState& initial) {
  auto& motion = initial.state.motion;
  auto& sigma = initial.sigma;
  sigma.segment<3>(kPosition).setConstant(0.01);
  if (setup.start) {
    motion.position_odom = setup.start->T_odom_robot.position;
    sigma.segment<3>(kPosition).setConstant(setup.start->position_sigma_m);
  } else {
    const Matrix3d& R = motion.R_odom_robot;
    if (first.usbl.any()) {
      const Vector3d lever =
          setup.vehicle.usbl ? setup.vehicle.usbl->T_robot_usbl.position : Vector3d::Zero();
      motion.position_odom = first.usbl.value() - R * lever;
      sigma.segment<3>(kPosition).setConstant(setup.vehicle.usbl ? setup.vehicle.usbl->position_sigma_m
                                                                 : 1.0);
    }
    if (first.depth_z.any()) {
      motion.position_odom.z() = first.depth_z.value().z();
      sigma[kPosition + 2] = 0.1;
    }
    initial.source += first.usbl.any()      ? "; position: USBL"
                      : first.depth_z.any() ? "; position: zero by definition, height from pressure"
                                            : "; position: zero by definition";
  }
}

/// The sigmas cover what a robot does within the first seconds.
void alignMotion(const FirstReadings& first, InitialState& initial) {
  auto& motion = initial.state.motion;
  auto& sigma = initial.sigma;
  if (first.velocity.any()) motion.velocity_robot = first.velocity.value();
  sigma.segment<3>(kVelocity).setConstant(first.velocity.any() ? 0.2 : 1.0);
  if (first.rate.any()) motion.angular_velocity_robot = first.rate.value();
  sigma.segment<3>(kAngularVelocity).setConstant(0.2);
  sigma.segment<3>(kAcceleration).setConstant(0.5);
}

/// What hardly changes: biases, offsets, the sea floor. Orientation and position must be known.
void alignSlowStates(const LocalizationSetup& setup, const FirstReadings& first, InitialState& initial) {
  const auto& motion = initial.state.motion;
  auto& sigma = initial.sigma;
  if (const auto& ins = setup.vehicle.ins) {
    sigma.segment<3>(kGyroBias).setConstant(ins->gyro_bias_sigma_rad_s);
    sigma.segment<3>(kAccelerometerBias).setConstant(ins->accelerometer_bias_sigma_m_s2);
  }
  if (setup.vehicle.depth) sigma[kPressureOffset] = setup.vehicle.depth->pressure_offset_sigma_pa;
  if (first.floor_depth.any())
    initial.state.sea_floor_z_m =
        motion.position_odom.z() + (motion.R_odom_robot * first.floor_depth.value()).z();
  sigma[kSeaFloor] = std::hypot(0.5, sigma[kPosition + 2]);
}

}  // namespace

InitialState alignInitially(const LocalizationSetup& setup, const std::vector<Sample>& samples) {
  const FirstReadings first = readAll(setup, samples);
  InitialState initial;
  initial.t_s = secondsBetween(setup.time_zero, samples.front().time);
  initial.sigma.setZero();
  alignOrientation(setup, first, initial);
  alignPosition(setup, first, initial);
  alignMotion(first, initial);
  alignSlowStates(setup, first, initial);
  return initial;
}

}  // namespace fathom
