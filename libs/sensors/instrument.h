#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "core/geometry.h"
#include "core/instance.h"
#include "core/random.h"
#include "sensors/inputs.h"

/// What instruments are made of. An instrument is what writes entries of a recording (INS, DVL, DEPTH, …); a
/// channel is what of an entry is compared with a model (gyro, accelerometer, attitude, dvl, …). All that the
/// program knows of one stands in its header: its part of the vehicle file, its entries, its equations, its
/// noise. sensors/all_instruments.h lists them; to add one, see libs/README.md.
namespace fathom {

/// A channel's name, units and what is usual of it.
struct ChannelText {
  std::string_view id{};     ///< in configs and results
  std::string_view label{};  ///< of the recording's entries that it is taken from
  /// As people read it: the measurement's own unit (SI) times `scale`.
  std::string_view unit{};
  double scale = 1;
  std::string_view metric{};  ///< of its residuals' root mean square, in results
  /// A misfit below this root mean square matters to nobody; own unit.
  double material = 0;
  std::array<std::string_view, 3> components{"x", "y", "z"};
  int component_count = 3;
  bool is_of_images = false;
  bool has_outliers = false;  ///< the batch estimate down-weights them (Huber)
  bool is_filtered = true;    ///< fused by the filter
  bool is_estimated = true;   ///< part of the batch estimate
  bool is_averaged = false;  ///< comes faster than a path can follow: means over knot intervals are estimated
  bool shows_motion = false;  ///< the path between fixes can be told from it
  /// What it tells a filter that may be lost: nothing by itself, the velocity, or where the vehicle is.
  enum class Tells { nothing, velocity, position } tells = Tells::nothing;
  /// What the first measurements tell of a start from which nothing is known, and of which field of Inputs.
  enum class Start {
    nothing,
    specific_force,  ///< acceleration_robot without gravity
    orientation,     ///< R_odom_robot
    heading,         ///< its yaw
    rate,            ///< angular_velocity_robot
    velocity,        ///< velocity_robot
    position,        ///< position_odom
    height,          ///< its z
    sea_floor        ///< sea_floor_z_m
  } start = Start::nothing;
  bool is_indirect =
      false;  ///< depends on what is no more than assumed (a flat sea floor): contradicts nobody
};

/// One measurement of one channel, taken from an entry: at most three components, own unit.
struct Observation {
  using Value = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
  using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
  Value value;  ///< of a rotation: zero, see `about`
  Covariance covariance;
  Pose T_robot_sensor;  ///< nominal mounting, as the entry has it
  /// A rotation is measured as its rotation vector from this one, R_odom_sensor.
  Matrix3d about = Matrix3d::Identity();
  Instance instance{};  ///< whose it is, where a vehicle has several of the kind

  static Observation scalar(double value, double sigma, const Pose& T_robot_sensor) {
    return {Value::Constant(1, value), Covariance::Constant(1, 1, sigma * sigma), T_robot_sensor};
  }
  static Observation vector(const Vector3d& value, const Vector3d& sigma, const Pose& T_robot_sensor) {
    return {value, sigma.cwiseAbs2().asDiagonal().toDenseMatrix(), T_robot_sensor};
  }
  /// `error_root`: a square root of the covariance of its rotation vector, sensor axes.
  static Observation rotation(const Matrix3d& R_odom_sensor, const Matrix3d& error_root,
                              const Pose& T_robot_sensor) {
    return {Vector3d::Zero(), error_root * error_root.transpose(), T_robot_sensor, R_odom_sensor};
  }
  static Observation rotation(const Matrix3d& R_odom_sensor, double sigma_rad, const Pose& T_robot_sensor) {
    return rotation(R_odom_sensor, Matrix3d::Identity() * sigma_rad, T_robot_sensor);
  }
};

/// What a channel is off by for a while, besides white noise: a first-order Gauss-Markov process, stationary
/// at first. It enters through an effect, the channel's DriftEffect.
struct Drift {
  double sigma = 0;                                                  ///< stationary, own unit, each component
  double time_constant_s = std::numeric_limits<double>::infinity();  ///< infinite: constant
  double rate_hz = 1;                                                ///< of the measurements

  bool isConstant() const { return time_constant_s == std::numeric_limits<double>::infinity(); }
  /// Variance of each measurement for whoever has no state for the drift and takes it for white noise: as
  /// much power as the process has at frequency zero, where it has most, so 2 sigma² tau times the rate
  /// (Brown & Hwang 2012, sec. 3.6). What is constant counts as if it lasted for half an hour.
  double whiteVariance() const {
    constexpr double kLasting_s = 1800;
    return 2 * sigma * sigma * (isConstant() ? kLasting_s : time_constant_s) * rate_hz;
  }
};

template <class T>
using Vector1 = Eigen::Matrix<T, 1, 1>;

/// One number, vector or rotation of an entry: its names in tables, the fault that adds to it, its bounds.
struct ValueText {
  /// Of what is geodetic, latitude and longitude in degrees and height in metres, faults add metres east,
  /// north and up.
  enum class Kind { scalar, vector, rotation, geodetic };
  std::string_view name{};  ///< of columns: "velocity_dvl" gives velocity_dvl_x_m_s, …
  std::string_view unit{};  ///< their suffix
  Kind kind = Kind::vector;
  std::string_view absent{};  ///< what an entry lacks that has none of it; empty: it always has it
  std::string_view fault{};   ///< key of the amount that faults add; empty: none does
  /// What no underwater vehicle does, and no sea allows, of each component. Equal: no bounds.
  double lowest = 0, highest = 0;
  /// What a corrupted entry of a slow vehicle could read, of each component.
  double wild_low = 0, wild_high = 0;
  double least = 0;  ///< of a scalar that is there: less stands for "none" in a recording
};

/// What a simulated instrument draws from: a random stream of its own for each purpose, so that leaving one
/// out changes no other's noise.
struct SimulatedNoise {
  std::uint64_t seed = 1;
  bool on = true;
  /// A beam of sound has an echo between these slant ranges, m.
  double beam_min_range_m = 0.05, beam_max_range_m = 50.0;
  Instance instance{};  ///< whose it is: each has streams of its own

  Random stream(std::uint64_t number) const {
    return Random::stream(seed, number + (instance.number() << kStreamBits));
  }
  double sigma(double of_sheet) const { return on ? of_sheet : 0.0; }

 private:
  static constexpr int kStreamBits = 8;  // of all that instruments draw from
};

}  // namespace fathom
