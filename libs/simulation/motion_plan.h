#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/yaml.h"
#include "simulation/trajectory.h"

/// What the kinds of trajectory files share: legs from rest to rest with sway on top.
namespace fathom {

/// x, y, z in m, then yaw, pitch, roll in rad and not wrapped: robot in odom, MRPT order.
using Coordinates = Eigen::Matrix<double, 6, 1>;
/// Reads x, y, z and yaw_deg, and pitch_deg and roll_deg where they are there.
Coordinates readCoordinates(const YamlMap& y);

/// How fast a leg goes.
struct Pace {
  double speed_m_s = 0.4;
  double turn_rate_rad_s = radians(20.0);
  double ramp_s = 2.0;  ///< time to speed up and to slow down

  /// Keys speed_m_s, turn_rate_deg_s and ramp_s, where they are there.
  void read(const YamlMap& y);
  /// Of a leg, at rest at both ends; the slower of way and turn sets it.
  double duration_s(const Coordinates& from, const Coordinates& to) const;
};

/// A motion from rest to rest, leg by leg.
class MotionPlan {
 public:
  static constexpr double kShortestEndHold_s = 2.0;  ///< the first and last hold last at least this long

  explicit MotionPlan(const Coordinates& start) : here_(start) {}

  const Coordinates& here() const { return here_; }
  double duration_s() const { return duration_s_; }
  /// Throws std::length_error beyond 30 days.
  void moveTo(const Coordinates& there, double duration_s, double ramp_s);
  void hold(double duration_s) { moveTo(here_, duration_s, 0.0); }
  /// Key `sway`, where it is there: see read_trajectory.h. A phase that is not given is drawn from the seed
  /// under the key `sway_seed`; without that it is 0.
  void readSway(const YamlMap& y);

  /// The smooth motion; sway grows after the first hold and fades before the last. `name` is for errors.
  Trajectory trajectory(const std::string& name) const;

 private:
  struct Leg {  ///< a hold, where `from` and `to` are the same
    double start_s = 0, duration_s = 0, ramp_s = 0;
    Coordinates from, to;
    Coordinates at(double t_s) const;
  };
  struct Sway {
    int axis = 0;
    double amplitude = 0, period_s = 1, phase = 0;  ///< m or rad; rad
  };
  static Sway readOneSway(const YamlMap& y, double phase);

  Coordinates here_;
  double duration_s_ = 0;
  std::vector<Leg> legs_;
  std::vector<Sway> sways_;
};

}  // namespace fathom
