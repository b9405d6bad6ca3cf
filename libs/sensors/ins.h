#pragma once

#include <cmath>
#include <optional>
#include <tuple>
#include <vector>

#include "core/gauss_markov.h"
#include "sensors/instrument.h"

namespace fathom {

/// How well an attitude is known: the angles turn about the vertical (heading) and about the two level axes
/// of the robot as it heads (pitch, roll), rad.
struct AttitudeSigma {
  double roll_rad = 0, pitch_rad = 0, heading_rad = 0;

  AttitudeSigma() = default;
  AttitudeSigma(double each_rad) : roll_rad(each_rad), pitch_rad(each_rad), heading_rad(each_rad) {}
  AttitudeSigma(double roll, double pitch, double heading)
      : roll_rad(roll), pitch_rad(pitch), heading_rad(heading) {}

  bool isOneOfAll() const { return roll_rad == pitch_rad && pitch_rad == heading_rad; }
  /// A square root of the covariance of the rotation vector in the INS's axes.
  Matrix3d errorRoot(const Matrix3d& R_odom_ins, const Pose& T_robot_ins) const {
    if (isOneOfAll()) return Matrix3d::Identity() * heading_rad;
    const Matrix3d R_odom_robot = R_odom_ins * T_robot_ins.rotation.transpose();
    const Vector3d forward = R_odom_robot.col(0);
    const Matrix3d level = rotationFromYawPitchRoll(std::atan2(forward.y(), forward.x()), 0, 0);
    return R_odom_ins.transpose() * level * Vector3d(roll_rad, pitch_rad, heading_rad).asDiagonal();
  }
};

/// Section `ins` of the vehicle file.
struct InsSheet {
  double rate_hz = 100;
  double gyro_sigma_rad_s = 0.001;              ///< white, each sample
  double accelerometer_sigma_m_s2 = 0.01;       ///< white, each sample
  double gyro_bias_sigma_rad_s = 5e-5;          ///< stationary sigma of a first-order Gauss-Markov process
  double accelerometer_bias_sigma_m_s2 = 3e-3;  ///< likewise
  double bias_time_constant_s = 120;
  /// Optional key: sigma of the attitude, where the INS gives one: a number, or [roll, pitch, heading];
  /// absent, its attitude is used for the start only.
  std::optional<AttitudeSigma> attitude_sigma;
  Pose T_robot_ins;

  template <class Fields>
  void fields(Fields&& f) {
    f.positive("rate_hz", rate_hz);
    f.positive("gyro_sigma_rad_s", gyro_sigma_rad_s);
    f.positive("accelerometer_sigma_m_s2", accelerometer_sigma_m_s2);
    f.notNegative("gyro_bias_sigma_rad_s", gyro_bias_sigma_rad_s);
    f.notNegative("accelerometer_bias_sigma_m_s2", accelerometer_bias_sigma_m_s2);
    f.positive("bias_time_constant_s", bias_time_constant_s);
    f.optionalAngles("attitude_sigma_deg", attitude_sigma);
    f.pose("pose", T_robot_ins);
  }
};

/// An entry INS.
struct InsSample {
  Pose T_robot_ins;
  std::optional<Vector3d> angular_velocity_ins;  ///< rad/s
  std::optional<Vector3d> specific_force_ins;    ///< m/s², +9.81 on the up axis at rest
  /// Attitude, where the INS gives one; NaN where its quaternion is not of unit norm (to 1 %).
  std::optional<Matrix3d> R_odom_ins;
};

/// The inertial navigation system (INS): gyros, accelerometers, and what it makes of them.
struct Ins {
  static constexpr const char* label = "INS";
  static constexpr std::string_view section = "ins", kind = "INS";
  using Instrument = Ins;
  using Sheet = InsSheet;
  using Sample = InsSample;
  struct OnBoard {
    std::optional<InsSheet> ins;
  };
  static constexpr auto on_board = &OnBoard::ins;

  static constexpr std::array values{ValueText{.name = "angular_velocity_ins",
                                               .unit = "rad_s",
                                               .absent = "angular velocity",
                                               .fault = "gyro_rad_s",
                                               .lowest = -50,
                                               .highest = 50,
                                               .wild_low = -2,
                                               .wild_high = 2},
                                     ValueText{.name = "specific_force_ins",
                                               .unit = "m_s2",
                                               .absent = "specific force",
                                               .fault = "accelerometer_m_s2",
                                               .lowest = -500,
                                               .highest = 500,
                                               .wild_low = -20,
                                               .wild_high = 20},
                                     ValueText{.name = "q_odom_ins",
                                               .unit = "",
                                               .kind = ValueText::Kind::rotation,
                                               .absent = "attitude",
                                               .fault = "attitude_deg",  // a rotation vector in its axes
                                               .wild_high = 2}};
  /// f(number in `values`, pointer to the value, or null where there is none).
  template <class Entry, class F>
  static void forEachValue(Entry& s, F&& f) {
    f(0, s.angular_velocity_ins ? &*s.angular_velocity_ins : nullptr);
    f(1, s.specific_force_ins ? &*s.specific_force_ins : nullptr);
    f(2, s.R_odom_ins ? &*s.R_odom_ins : nullptr);
  }
  static std::vector<Pose> mountings(const InsSample& s) { return {s.T_robot_ins}; }
  static std::vector<Pose> mountings(const InsSheet& s) { return {s.T_robot_ins}; }

  class Simulated;
  using Channels = std::tuple<struct Gyro, struct Accelerometer, struct Attitude>;
};

/// Body rate in sensor axes. (The Earth's own rate is left out: effect earth-rotation.)
struct Gyro {
  using Instrument = Ins;
  static constexpr ChannelText channel{.id = "gyro",
                                       .label = Ins::label,
                                       .unit = "deg/s",
                                       .scale = degrees(1.0),
                                       .metric = "gyro_rms_deg_s",
                                       .material = radians(0.005),
                                       .is_averaged = true,
                                       .shows_motion = true,
                                       .start = ChannelText::Start::rate};
  using DriftEffect = GyroBias;
  static Drift drift(const InsSheet& s) {
    return {s.gyro_bias_sigma_rad_s, s.bias_time_constant_s, s.rate_hz};
  }
  template <class F>
  static void observe(const InsSample& s, const InsSheet& sheet, F&& f) {
    if (s.angular_velocity_ins)
      f(Observation::vector(*s.angular_velocity_ins, Vector3d::Constant(sheet.gyro_sigma_rad_s),
                            s.T_robot_ins));
  }
  /// rad/s, INS frame.
  template <class T>
  static Vector3<T> predict(const Inputs<T>& in, const InsSheet&, const Observation& seen) {
    return angularVelocity(in, seen.T_robot_sensor);
  }
  template <class T>
  static Vector3<T> angularVelocity(const Inputs<T>& in, const Pose& T_robot_ins) {
    const auto mount = in.template mounting<Ins>(T_robot_ins);
    return in
        .at(GyroReading<T>{mount.R_robot_sensor.transpose() * in.state.angular_velocity_robot,
                           in.state.R_odom_robot * mount.R_robot_sensor})
        .angular_velocity_ins;
  }
};

/// Specific force at the sensor, f = R_ins_robot (a + alpha x l + omega x (omega x l) - R_robot_odom g)
/// (Farrell 2008, eq. 11.31 and rigid body).
struct Accelerometer {
  using Instrument = Ins;
  static constexpr ChannelText channel{.id = "accelerometer",
                                       .label = Ins::label,
                                       .unit = "mm/s²",
                                       .scale = 1000,
                                       .metric = "accelerometer_rms_mm_s2",
                                       .material = 0.005,
                                       .is_averaged = true,
                                       .shows_motion = true,
                                       .start = ChannelText::Start::specific_force};
  using DriftEffect = AccelerometerBias;
  static Drift drift(const InsSheet& s) {
    return {s.accelerometer_bias_sigma_m_s2, s.bias_time_constant_s, s.rate_hz};
  }
  template <class F>
  static void observe(const InsSample& s, const InsSheet& sheet, F&& f) {
    if (s.specific_force_ins)
      f(Observation::vector(*s.specific_force_ins, Vector3d::Constant(sheet.accelerometer_sigma_m_s2),
                            s.T_robot_ins));
  }
  /// m/s², INS frame.
  template <class T>
  static Vector3<T> predict(const Inputs<T>& in, const InsSheet&, const Observation& seen) {
    return specificForce(in, seen.T_robot_sensor);
  }
  template <class T>
  static Vector3<T> specificForce(const Inputs<T>& in, const Pose& T_robot_ins) {
    const auto mount = in.template mounting<Ins>(T_robot_ins);
    const Vector3<T>& lever = mount.position_robot;
    const Vector3<T>& rate = in.state.angular_velocity_robot;
    const Vector3<T> gravity_robot =
        in.state.R_odom_robot.transpose() * in.world.gravity_odom.template cast<T>();
    const Vector3<T> at_sensor = in.state.acceleration_robot +
                                 in.state.angular_acceleration_robot.cross(lever) +
                                 rate.cross(rate.cross(lever));
    return in.at(AccelerometerReading<T>{mount.R_robot_sensor.transpose() * (at_sensor - gravity_robot)})
        .specific_force_ins;
  }
};

/// R_odom_ins, as the INS itself has it; measured as the rotation vector from there.
struct Attitude {
  using Instrument = Ins;
  static constexpr ChannelText channel{.id = "attitude",
                                       .label = Ins::label,
                                       .unit = "deg",
                                       .scale = degrees(1.0),
                                       .metric = "attitude_rms_deg",
                                       .material = radians(0.05),
                                       .is_averaged = true,
                                       .start = ChannelText::Start::orientation};
  template <class F>
  static void observe(const InsSample& s, const InsSheet& sheet, F&& f) {
    if (s.R_odom_ins && sheet.attitude_sigma)
      f(Observation::rotation(*s.R_odom_ins, sheet.attitude_sigma->errorRoot(*s.R_odom_ins, s.T_robot_ins),
                              s.T_robot_ins));
  }
  /// rad, INS frame.
  template <class T>
  static Vector3<T> predict(const Inputs<T>& in, const InsSheet&, const Observation& seen) {
    return logSO3<T>(seen.about.transpose().cast<T>() * orientation(in, seen.T_robot_sensor));
  }
  template <class T>
  static Matrix3<T> orientation(const Inputs<T>& in, const Pose& T_robot_ins) {
    return in.state.R_odom_robot * in.template mounting<Ins>(T_robot_ins).R_robot_sensor;
  }
};

/// White noise and first-order Gauss-Markov biases, which begin stationary and enter through the bias
/// effects.
class Ins::Simulated {
 public:
  static constexpr std::uint64_t kFirstStream = 0, kStreams = 3;

  Simulated(const InsSheet& sheet, const SimulatedNoise& noise)
      : sheet_(sheet),
        noise_(noise),
        step_(1.0 / sheet.rate_hz, sheet.bias_time_constant_s),
        white_(noise.stream(kFirstStream)),
        bias_(noise.stream(kFirstStream + 1)),
        attitude_(noise.stream(kFirstStream + 2)) {}

  /// What is drawn of effects for the next entry.
  void draw(EffectParameters<double>& effects) {
    if (!noise_.on) return;
    for (auto* bias : {&gyro_bias_, &force_bias_}) {
      const double sigma =
          bias == &gyro_bias_ ? sheet_.gyro_bias_sigma_rad_s : sheet_.accelerometer_bias_sigma_m_s2;
      *bias = now_.decay * *bias + now_.innovation() * (sigma * bias_.normal3());
    }
    now_ = step_;
    effects.add<GyroBias>({gyro_bias_.x(), gyro_bias_.y(), gyro_bias_.z()});
    effects.add<AccelerometerBias>({force_bias_.x(), force_bias_.y(), force_bias_.z()});
  }

  /// in: null where the motion at the time of validity is not known.
  InsSample read(const Inputs<double>* in) {
    const Vector3d gyro_error = noise_.sigma(sheet_.gyro_sigma_rad_s) * white_.normal3(),
                   force_error = noise_.sigma(sheet_.accelerometer_sigma_m_s2) * white_.normal3();
    InsSample sample{sheet_.T_robot_ins, {}, {}, {}};
    if (in == nullptr) return sample;
    sample.angular_velocity_ins = Gyro::angularVelocity(*in, sheet_.T_robot_ins) + gyro_error;
    sample.specific_force_ins = Accelerometer::specificForce(*in, sheet_.T_robot_ins) + force_error;
    if (sheet_.attitude_sigma) {
      const Matrix3d R_odom_ins = Attitude::orientation(*in, sheet_.T_robot_ins);
      const Vector3d error =
          noise_.sigma(1.0) *
          (sheet_.attitude_sigma->errorRoot(R_odom_ins, sheet_.T_robot_ins) * attitude_.normal3());
      sample.R_odom_ins = R_odom_ins * expSO3<double>(error);
    }
    return sample;
  }

 private:
  const InsSheet& sheet_;
  SimulatedNoise noise_;
  GaussMarkovStep step_, now_;
  Vector3d gyro_bias_ = Vector3d::Zero(), force_bias_ = Vector3d::Zero();
  Random white_, bias_, attitude_;
};

}  // namespace fathom
