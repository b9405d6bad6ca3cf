#include "dive.h"

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "given_path.h"

namespace fathom::sealed {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kCameraAhead_m = 0.35;  // of the robot's reference point: ranges are the camera's

/// Draws what makes one dive another than the next.
class Drawn {
 public:
  explicit Drawn(std::uint64_t seed) : random_(Random::stream(seed, 0)) {}

  double between(double low, double high) { return random_.uniform(low, high); }
  /// A slow swing, and a quicker one of a quarter of its size on top, so that no two quarters of the dive are
  /// alike.
  Swing swing(double mean, double amplitude, double slowest_rad_s, double fastest_rad_s) {
    const double slow = between(slowest_rad_s, fastest_rad_s);
    return {mean,
            {{amplitude * between(0.85, 1.0), slow, between(0, kTurn_rad)},
             {amplitude * between(0.15, 0.25), slow * between(1.6, 1.9), between(0, kTurn_rad)}}};
  }

 private:
  Random random_;
};

/// Keeps station `range_m` before the panel, moving by little.
std::array<Swing, 6> station(Drawn& drawn, const Vector3d& panel_odom, double range_m) {
  const double x = panel_odom.x() - kCameraAhead_m - range_m;
  return {drawn.swing(x, 0.03, 0.25, 0.6),
          drawn.swing(panel_odom.y(), 0.04, 0.25, 0.6),
          drawn.swing(panel_odom.z(), 0.03, 0.25, 0.6),
          drawn.swing(0, 0.02, 0.3, 0.6),
          drawn.swing(0, 0.015, 0.3, 0.6),
          drawn.swing(0, 0.02, 0.3, 0.6)};
}

/// Everything moves, each at its own pace, between 1.2 and 3.4 m from the panel.
std::array<Swing, 6> rich(Drawn& drawn, const Vector3d& panel_odom) {
  const double x = panel_odom.x() - kCameraAhead_m - 2.3;
  return {drawn.swing(x, 0.9, 0.20, 0.28),
          drawn.swing(panel_odom.y(), drawn.between(0.35, 0.5), 0.30, 0.42),
          drawn.swing(panel_odom.z(), drawn.between(0.18, 0.28), 0.26, 0.5),
          drawn.swing(0, drawn.between(0.2, 0.28), 0.34, 0.6),
          drawn.swing(0, drawn.between(0.06, 0.1), 0.3, 0.6),
          drawn.swing(0, drawn.between(0.06, 0.12), 0.3, 0.6)};
}

/// To and fro along the panel, looking a little ahead; a triangle's first waves turn smoothly at its ends.
std::array<Swing, 6> survey(Drawn& drawn, const Vector3d& panel_odom) {
  auto swings = station(drawn, panel_odom, drawn.between(1.8, 2.3));
  const double pace = drawn.between(0.2, 0.26), phase = drawn.between(0, kTurn_rad);
  const double half_width_m = drawn.between(0.8, 1.0), heading_rad = drawn.between(0.2, 0.3);
  swings[0].waves[0].amplitude = 0.25;
  swings[1] = {panel_odom.y(), {{half_width_m, pace, phase}, {-half_width_m / 9, 3 * pace, 3 * phase}}};
  // Its own position's derivative: a quarter of a wave ahead.
  const double ahead = phase + kTurn_rad / 4;
  swings[3] = {0, {{heading_rad, pace, ahead}, {heading_rad / 5, 3 * pace, 3 * ahead}}};
  swings[2].waves[0].amplitude = 0.15;
  return swings;
}

/// To the panel and back, several times, 0.8 to 4 m away.
std::array<Swing, 6> approach(Drawn& drawn, const Vector3d& panel_odom) {
  auto swings = station(drawn, panel_odom, 2.4);
  swings[0].waves = {{1.6, drawn.between(0.25, 0.32), drawn.between(0, kTurn_rad)}};
  swings[1].waves[0].amplitude = 0.12;
  swings[2].waves[0].amplitude = 0.10;
  swings[3].waves[0].amplitude = 0.08;
  return swings;
}

/// Turns on the spot, far enough to lose the panel for a while.
std::array<Swing, 6> turns(Drawn& drawn, const Vector3d& panel_odom) {
  auto swings = station(drawn, panel_odom, drawn.between(1.8, 2.2));
  swings[3].waves = {{drawn.between(1.2, 1.6), drawn.between(0.24, 0.32), drawn.between(0, kTurn_rad)}};
  swings[4].waves[0].amplitude = 0.06;
  swings[5].waves[0].amplitude = 0.08;
  return swings;
}

/// Nearer all the while for half a minute: range and time say the same.
std::array<Swing, 6> closing(Drawn& drawn, const Vector3d& panel_odom) {
  auto swings = station(drawn, panel_odom, 2.3);
  swings[0].waves = {{1.6, drawn.between(0.045, 0.055), -drawn.between(0.7, 0.8)}};
  swings[1].waves[0].amplitude = 0.12;
  swings[2].waves[0].amplitude = 0.10;
  swings[3].waves[0].amplitude = 0.08;
  return swings;
}

std::array<Swing, 6> swingsOf(const std::string& manoeuvre, Drawn& drawn, const Vector3d& panel_odom) {
  if (manoeuvre == "rich") return rich(drawn, panel_odom);
  if (manoeuvre == "survey") return survey(drawn, panel_odom);
  if (manoeuvre == "approach") return approach(drawn, panel_odom);
  if (manoeuvre == "closing") return closing(drawn, panel_odom);
  if (manoeuvre == "turns") return turns(drawn, panel_odom);
  return station(drawn, panel_odom, drawn.between(1.6, 2.2));
}

/// Swings of x, y, z in odom [m], yaw, pitch, roll [rad]. Angular velocity from Euler angles' rates, and its
/// derivative (e.g. Diebel 2006, sec. 5.6, order 3-2-1).
Motion motionOf(const std::array<Swing, 6>& swings, double t_s) {
  std::array<Coordinate, 6> c;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = swings[i].at(t_s);
  const auto& [x, y, z, yaw, pitch, roll] = c;
  const double sp = std::sin(pitch.value), cp = std::cos(pitch.value);
  const double sr = std::sin(roll.value), cr = std::cos(roll.value);

  Motion motion;
  motion.T_odom_robot = {rotationFromYawPitchRoll(yaw.value, pitch.value, roll.value),
                         {x.value, y.value, z.value}};
  motion.velocity_odom = {x.rate, y.rate, z.rate};
  motion.acceleration_odom = {x.acceleration, y.acceleration, z.acceleration};
  motion.rate_robot = {roll.rate - yaw.rate * sp, pitch.rate * cr + yaw.rate * cp * sr,
                       -pitch.rate * sr + yaw.rate * cp * cr};
  motion.angular_acceleration_robot = {
      roll.acceleration - yaw.acceleration * sp - yaw.rate * pitch.rate * cp,
      pitch.acceleration * cr - pitch.rate * roll.rate * sr + yaw.acceleration * cp * sr -
          yaw.rate * pitch.rate * sp * sr + yaw.rate * roll.rate * cp * cr,
      -pitch.acceleration * sr - pitch.rate * roll.rate * cr + yaw.acceleration * cp * cr -
          yaw.rate * pitch.rate * sp * cr - yaw.rate * roll.rate * cp * sr};
  return motion;
}

}  // namespace

Coordinate Swing::at(double t_s) const {
  Coordinate c{mean, 0, 0};
  for (const Wave& wave : waves) {
    const double sine = std::sin(wave.rate_rad_s * t_s + wave.phase_rad);
    const double cosine = std::cos(wave.rate_rad_s * t_s + wave.phase_rad);
    c.value += wave.amplitude * sine;
    c.rate += wave.amplitude * wave.rate_rad_s * cosine;
    c.acceleration -= wave.amplitude * wave.rate_rad_s * wave.rate_rad_s * sine;
  }
  return c;
}

Dive makeDive(const std::string& manoeuvre, std::uint64_t seed, const Vector3d& panel_odom) {
  Drawn drawn(seed);
  return Dive(
      [swings = swingsOf(manoeuvre, drawn, panel_odom)](double t_s) { return motionOf(swings, t_s); });
}

Dive makeDive(const DiveCase& dive, const Vector3d& panel_odom) {
  if (dive.manoeuvre != "given") return makeDive(dive.manoeuvre, dive.seed, panel_odom);
  return Dive([path = GivenPath(dive.path, dive.duration_s)](double t_s) { return path.at(t_s); });
}

}  // namespace fathom::sealed
