#include "localization/alignment.h"

#include <Eigen/LU>

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

/// What the first seconds say, whatever the attitude.
struct FirstReadings {
  Mean specific_force;  ///< at the robot's reference point, in its axes
  Mean usbl;            ///< the transponder, odom
  Mean depth_z;         ///< z only: height of the robot if it were level
  std::optional<Matrix3d> R_odom_robot;
};

/// And once it is known.
struct FirstMotion {
  Mean rate, velocity;  ///< in robot axes
  Mean floor_z;         ///< z only: the sea floor's height
};

/// What a sensor saw, from what it read: models are affine in that, effects included.
template <int N, class Model>
Eigen::Matrix<double, N, 1> seenBy(const Model& model, const Eigen::Matrix<double, N, 1>& reading) {
  using Vector = Eigen::Matrix<double, N, 1>;
  const Vector of_nothing = model(Vector::Zero());
  Eigen::Matrix<double, N, N> slope;
  for (int i = 0; i < N; ++i) slope.col(i) = model(Vector::Unit(i)) - of_nothing;
  return slope.inverse() * (reading - of_nothing);
}

void read(const InsSample& ins, double t_s, const LocalizationSetup& setup, FirstReadings& first) {
  if (ins.specific_force_ins) {
    const auto pushedBy = [&](const Vector3d& force_robot) {
      KinematicState<double> state;
      state.acceleration_robot = force_robot;
      return predictSpecificForce(state, World<double>{Vector3d::Zero()}, ins.T_robot_ins, setup.calibration,
                                  t_s);
    };
    first.specific_force.add(seenBy<3>(pushedBy, *ins.specific_force_ins));
  }
  if (ins.R_odom_ins && !first.R_odom_robot && ins.R_odom_ins->allFinite())
    first.R_odom_robot =
        *ins.R_odom_ins *
        predictAttitude(KinematicState<double>{}, ins.T_robot_ins, setup.calibration, t_s).transpose();
}

/// Height of the robot if it were level: pressure is linear in it.
double height_m(const DepthSample& depth, double t_s, const LocalizationSetup& setup) {
  using Scalar = Eigen::Matrix<double, 1, 1>;
  const auto pressureAt = [&](const Scalar& z) {
    KinematicState<double> level;
    level.position_odom.z() = z[0];
    return Scalar(predictPressure(level, World<double>{setup.vehicle.gravityOdom()}, *setup.vehicle.depth,
                                  depth.T_robot_depth, setup.calibration, t_s));
  };
  return seenBy<1>(pressureAt, Scalar(depth.pressure_pa))[0];
}

FirstReadings readAll(const LocalizationSetup& setup, const std::vector<Sample>& samples) {
  FirstReadings first;
  for (const Sample& sample : samples) {
    const double t_s = secondsBetween(setup.time_zero, sample.time);
    if (const auto* ins = std::get_if<InsSample>(&sample.reading)) read(*ins, t_s, setup, first);
    if (const auto* depth = std::get_if<DepthSample>(&sample.reading); depth && setup.vehicle.depth)
      first.depth_z.add({0, 0, height_m(*depth, t_s, setup)});
    if (const auto* pose = std::get_if<PoseSample>(&sample.reading); pose && sample.label == labels::kUsbl)
      first.usbl.add(pose->T_odom_robot.mean.position);
  }
  return first;
}

/// `at`: the robot's pose, at rest.
FirstMotion readMotion(const LocalizationSetup& setup, const std::vector<Sample>& samples,
                       const KinematicState<double>& at) {
  using Scalar = Eigen::Matrix<double, 1, 1>;
  FirstMotion first;
  for (const Sample& sample : samples) {
    const double t_s = secondsBetween(setup.time_zero, sample.time);
    if (const auto* ins = std::get_if<InsSample>(&sample.reading); ins && ins->angular_velocity_ins) {
      const auto turnedBy = [&](const Vector3d& rate_robot) {
        KinematicState<double> state = at;
        state.angular_velocity_robot = rate_robot;
        return predictGyro(state, ins->T_robot_ins, setup.calibration, t_s);
      };
      first.rate.add(seenBy<3>(turnedBy, *ins->angular_velocity_ins));
    }
    if (const auto* dvl = std::get_if<DvlSample>(&sample.reading);
        dvl && dvl->velocity_dvl && !first.velocity.any()) {
      const auto movedBy = [&](const Vector3d& velocity_robot) {
        KinematicState<double> state = at;
        state.velocity_robot = velocity_robot;
        return predictDvlVelocity(state, dvl->T_robot_dvl, setup.calibration, t_s);
      };
      first.velocity.add(seenBy<3>(movedBy, *dvl->velocity_dvl));
    }
    if (const auto* beams = std::get_if<DvlBeamsSample>(&sample.reading))
      for (const DvlBeam& beam : beams->beams) {
        const auto rangeTo = [&](const Scalar& floor_z) {
          const Pose T_robot_dvl = setup.vehicle.dvl.value_or(DvlSheet{}).T_robot_dvl;
          return Scalar(predictBeamRange(at, World<double>{setup.vehicle.gravityOdom(), floor_z[0]},
                                         T_robot_dvl, beam.T_robot_beam, setup.calibration, t_s));
        };
        if (beam.range_m) first.floor_z.add({0, 0, seenBy<1>(rangeTo, Scalar(*beam.range_m))[0]});
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
    if (first.usbl.any()) {
      const Pose T_robot_usbl = setup.vehicle.usbl ? setup.vehicle.usbl->T_robot_usbl : Pose{};
      motion.position_odom = first.usbl.value() - predictUsbl(motion, T_robot_usbl);
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
  alignPosition(setup, first, initial);
  const FirstMotion motion = readMotion(setup, samples, initial.state.motion);
  alignMotion(motion, initial);
  alignSlowStates(setup, motion, initial);
  return initial;
}

}  // namespace fathom
