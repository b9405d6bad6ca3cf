#include "localization/alignment.h"

#include "localization/seen.h"

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

using Start = ChannelText::Start;

/// What the first seconds say, whatever the attitude.
struct FirstReadings {
  Mean specific_force;  ///< at the robot's reference point, in its axes
  Mean height_z;        ///< z only: of the robot if it were level
  Mean heading;         ///< x, y: its unit vector
  std::optional<Matrix3d> R_odom_robot;
  double heading_sigma_rad = 0;
};

/// And once it is known.
struct FirstMotion {
  Mean position, rate, velocity;  ///< odom; robot axes
  double position_sigma_m = 0;
  std::string position_label;
  Mean floor_z;  ///< z only: the sea floor's height
};

FirstReadings readAll(const LocalizationSetup& setup, const std::vector<Sample>& samples) {
  FirstReadings first;
  forEachSeen(setup, samples, {}, [&](const Seen& seen) {
    const Start start = textOf(seen.channel).start;
    if (start == Start::specific_force)
      first.specific_force.add(seen.where([](Inputs<double>& in, const Vector3d& force_robot) {
        in.world.gravity_odom.setZero();
        in.state.acceleration_robot = force_robot;
      }));
    if (start == Start::height)
      first.height_z.add(
          seen.where([](Inputs<double>& in, const Vector3d& p) { in.state.position_odom = p; }, 2));
    if (start == Start::heading) {
      // The prediction at no heading is what the heading is measured from.
      const double yaw = (seen.observation.value -
                          modelOf(seen.channel).predict(seen.at, seen.vehicle, seen.observation))[0];
      first.heading.add({std::cos(yaw), std::sin(yaw), 0});
      first.heading_sigma_rad = std::sqrt(seen.observation.covariance(0, 0));
    }
  });
  // An attitude counts whether its sigma is known or not.
  for (const Sample& sample : samples)
    if (const auto* ins = std::get_if<InsSample>(&sample.reading);
        ins && ins->R_odom_ins && !first.R_odom_robot && ins->R_odom_ins->allFinite()) {
      const Inputs<double> at{{},
                              {},
                              setup.calibration.of(Instance::of(sample.label)),
                              secondsBetween(setup.time_zero, sample.time)};
      first.R_odom_robot = *ins->R_odom_ins * Attitude::orientation(at, ins->T_robot_ins).transpose();
    }
  return first;
}

/// `at`: the robot, at rest; its position is not known yet.
FirstMotion readMotion(const LocalizationSetup& setup, const std::vector<Sample>& samples,
                       const KinematicState<double>& at) {
  FirstMotion first;
  forEachSeen(setup, samples, at, [&](const Seen& seen) {
    const Start start = textOf(seen.channel).start;
    if (start == Start::position) {
      first.position.add(
          seen.where([](Inputs<double>& in, const Vector3d& p) { in.state.position_odom = p; }));
      first.position_sigma_m = std::sqrt(seen.observation.covariance.diagonal().maxCoeff());
      first.position_label = textOf(seen.channel).label;
    }
    if (start == Start::rate)
      first.rate.add(
          seen.where([](Inputs<double>& in, const Vector3d& w) { in.state.angular_velocity_robot = w; }));
    if (start == Start::velocity && !first.velocity.any())
      first.velocity.add(
          seen.where([](Inputs<double>& in, const Vector3d& v) { in.state.velocity_robot = v; }));
    if (start == Start::sea_floor)
      first.floor_z.add(
          seen.where([](Inputs<double>& in, const Vector3d& z) { in.world.sea_floor_z_m = z.z(); }, 2));
  });
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
    constexpr double kLeast_rad = radians(0.05);
    if (const auto sigma = setup.vehicle.ins ? setup.vehicle.ins->attitude_sigma : std::nullopt) {
      tilt_sigma = std::max({sigma->roll_rad, sigma->pitch_rad, kLeast_rad});
      yaw_sigma = std::max(sigma->heading_rad, kLeast_rad);
    }
    initial.source = "orientation: INS attitude";
  } else if (first.specific_force.any()) {
    // Leveled while the vehicle may accelerate by some 0.1 m/s²; heading zero defines odom's x axis.
    motion.R_odom_robot = level(first.specific_force.value());
    tilt_sigma = radians(1.0);
    yaw_sigma = radians(0.01);
    initial.defined.heading = !first.heading.any();
    initial.source = "orientation: leveled by gravity, heading zero by definition";
    if (first.heading.any()) {
      const Vector3d mean = first.heading.value();
      motion.R_odom_robot =
          rotationFromYawPitchRoll(std::atan2(mean.y(), mean.x()), 0, 0) * motion.R_odom_robot;
      yaw_sigma = std::max(first.heading_sigma_rad, radians(2.0));
      initial.source = "orientation: leveled by gravity, heading measured";
    }
  } else {
    tilt_sigma = radians(5.0);
    yaw_sigma = radians(0.01);
    initial.defined.heading = true;
    initial.source = "orientation: assumed level, heading zero by definition";
  }
  initial.sigma.segment<3>(kOrientation) << tilt_sigma, tilt_sigma, yaw_sigma;
}

/// The orientation must be known.
void alignPosition(const LocalizationSetup& setup, const FirstReadings& first, const FirstMotion& motion,
                   InitialState& initial) {
  Vector3d& position = initial.state.motion.position_odom;
  auto& sigma = initial.sigma;
  sigma.segment<3>(kPosition).setConstant(0.01);
  if (setup.start) {
    position = setup.start->T_odom_robot.position;
    sigma.segment<3>(kPosition).setConstant(setup.start->position_sigma_m);
    return;
  }
  // One position may be false: those that agree move the frame, and go on to where its heading is not known.
  initial.defined.position = true;
  initial.defined.height = !first.height_z.any();
  if (motion.position.any()) {
    position = motion.position.value();
    sigma.segment<3>(kPosition).setConstant(motion.position_sigma_m);
  }
  if (first.height_z.any()) {
    position.z() = first.height_z.value().z();
    sigma[kPosition + 2] = 0.1;
  }
  initial.source += motion.position.any()  ? "; position: " + motion.position_label
                    : first.height_z.any() ? "; position: zero by definition, height from pressure"
                                           : "; position: zero by definition";
}

/// The sigmas cover what a robot does within the first seconds.
void alignMotion(const FirstMotion& first, InitialState& initial) {
  auto& motion = initial.state.motion;
  auto& sigma = initial.sigma;
  if (first.velocity.any()) motion.velocity_robot = first.velocity.value();
  sigma.segment<3>(kVelocity).setConstant(first.velocity.any() ? 0.2 : 1.0);
  if (first.rate.any()) motion.angular_velocity_robot = first.rate.value();
  sigma.segment<3>(kAngularVelocity).setConstant(0.2);
  sigma.segment<3>(kAcceleration).setConstant(0.5);
}

/// What hardly changes: biases, offsets, the sea floor.
void alignSlowStates(const LocalizationSetup& setup, const FirstMotion& first, InitialState& initial) {
  auto& sigma = initial.sigma;
  if (const auto& ins = setup.vehicle.ins) {
    sigma.segment<3>(kGyroBias).setConstant(ins->gyro_bias_sigma_rad_s);
    sigma.segment<3>(kAccelerometerBias).setConstant(ins->accelerometer_bias_sigma_m_s2);
  }
  if (setup.vehicle.depth) sigma[kPressureOffset] = setup.vehicle.depth->pressure_offset_sigma_pa;
  if (first.floor_z.any()) initial.state.sea_floor_z_m = first.floor_z.value().z();
  sigma[kSeaFloor] = std::hypot(0.5, sigma[kPosition + 2]);
}

}  // namespace

InitialState alignInitially(const LocalizationSetup& setup, const std::vector<Sample>& samples) {
  const FirstReadings first = readAll(setup, samples);
  InitialState initial;
  initial.t_s = secondsBetween(setup.time_zero, samples.front().time);
  initial.sigma.setZero();
  alignOrientation(setup, first, initial);
  alignPosition(setup, first, readMotion(setup, samples, initial.state.motion), initial);
  const FirstMotion motion =
      readMotion(setup, samples, initial.state.motion);  // the sea floor's height is the robot's
  alignMotion(motion, initial);
  alignSlowStates(setup, motion, initial);
  return initial;
}

}  // namespace fathom
