#include "simulation/waypoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/yaml.h"

namespace fathom {
namespace {

/// x, y, z in m, then yaw, pitch, roll in rad and not wrapped.
using Coordinates = Eigen::Matrix<double, 6, 1>;
constexpr std::array<const char*, 6> kAxes{"x", "y", "z", "yaw", "pitch", "roll"};

constexpr double kKnotInterval_s = 0.2;
constexpr double kShortestEndHold_s = 2.0;  // ten knots: a spline forgets its end condition by 3.7 a knot
constexpr double kSwayFade_s = 8.0;
constexpr double kLongest_s = 30 * 86400.0;

struct Leg {  ///< a hold, where `from` and `to` are the same
  double start_s = 0, duration_s = 0, ramp_s = 0;
  Coordinates from, to;
};

struct Sway {
  int axis = 0;
  double amplitude = 0, period_s = 1, phase = 0;  ///< m or rad; rad
};

struct Plan {
  std::vector<Leg> legs;
  std::vector<Sway> sways;
  double duration_s = 0;
};

Coordinates readCoordinates(const YamlMap& y) {
  const auto angle = [&](const std::string& key) { return y.has(key) ? radians(y.number(key)) : 0.0; };
  // All read first: Eigen's comma initializer asserts where an exception cuts it short.
  const std::array<double, 6> values{y.number("x"),      y.number("y"),
                                     y.number("z"),      radians(y.number("yaw_deg")),
                                     angle("pitch_deg"), angle("roll_deg")};
  return Coordinates(values.data());
}

Sway readSway(const YamlMap& y) {
  Sway sway;
  const std::string axis = y.text("axis");
  const auto found = std::find(kAxes.begin(), kAxes.end(), axis);
  if (found == kAxes.end()) throw y.error("axis", "must be x, y, z, yaw, pitch or roll");
  sway.axis = static_cast<int>(found - kAxes.begin());
  sway.amplitude = sway.axis < 3 ? y.number("amplitude_m") : radians(y.number("amplitude_deg"));
  sway.period_s = y.positive("period_s");
  if (sway.period_s < 4 * kKnotInterval_s) throw y.error("period_s", "must be at least 0.8 s");
  if (y.has("phase_deg")) sway.phase = radians(y.number("phase_deg"));
  return sway;
}

/// Speeds of one leg: those of the file unless the waypoint has its own.
struct Pace {
  double speed_m_s = 0.4;
  double turn_rate_rad_s = radians(20.0);
  double ramp_s = 2.0;

  void read(const YamlMap& y) {
    if (y.has("speed_m_s")) speed_m_s = y.positive("speed_m_s");
    if (y.has("turn_rate_deg_s")) turn_rate_rad_s = radians(y.positive("turn_rate_deg_s"));
    if (y.has("ramp_s")) ramp_s = y.positive("ramp_s");
  }
  /// A leg of length L at speed v with ramps r takes L/v + r; a short one is all ramp.
  double duration_s(const Coordinates& from, const Coordinates& to) const {
    const double way_s = (to - from).head<3>().norm() / speed_m_s;
    const double turn_s = (to - from).tail<3>().cwiseAbs().maxCoeff() / turn_rate_rad_s;
    const double cruise_s = std::max(way_s, turn_s);
    return cruise_s > 0 ? std::max(cruise_s + ramp_s, 2 * ramp_s) : 0.0;
  }
};

void addLeg(Plan& plan, const Coordinates& from, const Coordinates& to, double duration_s, double ramp_s) {
  if (duration_s <= 0) return;
  plan.legs.push_back({plan.duration_s, duration_s, std::min(ramp_s, duration_s / 2), from, to});
  plan.duration_s += duration_s;
}

Plan readPlan(const YamlMap& y) {
  Plan plan;
  Pace pace;
  pace.read(y);
  const auto waypoints = y.maps("waypoints");
  if (waypoints.empty()) throw y.error("waypoints", "must have at least one entry");
  Coordinates here = readCoordinates(waypoints.front());
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const YamlMap& waypoint = waypoints[i];
    const Coordinates there = readCoordinates(waypoint);
    Pace leg_pace = pace;
    leg_pace.read(waypoint);
    double leg_s = leg_pace.duration_s(here, there);
    if (waypoint.has("t_s")) {
      if (waypoint.has("speed_m_s") || waypoint.has("turn_rate_deg_s"))
        throw waypoint.error("t_s", "cannot be given together with a speed");
      leg_s = waypoint.notNegative("t_s") - plan.duration_s;
      if (leg_s < 0 || (leg_s == 0 && there != here))
        throw waypoint.error("t_s", "must be later than the end of the waypoint before (" +
                                        std::to_string(plan.duration_s) + " s)");
    }
    addLeg(plan, here, there, leg_s, leg_pace.ramp_s);
    const bool at_end = i == 0 || i + 1 == waypoints.size();
    const double hold_s = waypoint.has("hold_s") ? waypoint.notNegative("hold_s") : 0.0;
    addLeg(plan, there, there, std::max(hold_s, at_end ? kShortestEndHold_s : 0.0), pace.ramp_s);
    if (plan.duration_s > kLongest_s) throw waypoint.error("", "the trajectory lasts more than 30 days");
    here = there;
  }
  if (y.has("sway"))
    for (const YamlMap& sway : y.maps("sway")) plan.sways.push_back(readSway(sway));
  return plan;
}

/// Share of a leg that is done: speed rises and falls as half a cosine, so acceleration is continuous.
double progress(double t_s, double duration_s, double ramp_s) {
  using std::numbers::pi;
  const double top_speed = 1.0 / (duration_s - ramp_s);
  const auto ramp = [&](double t) { return top_speed * (t - ramp_s / pi * std::sin(pi * t / ramp_s)) / 2; };
  if (t_s < ramp_s) return ramp(t_s);
  if (t_s > duration_s - ramp_s) return 1.0 - ramp(duration_s - t_s);
  return top_speed * (t_s - ramp_s / 2);
}

Coordinates along(const Leg& leg, double t_s) {
  const double in_leg_s = std::clamp(t_s - leg.start_s, 0.0, leg.duration_s);
  return leg.from + progress(in_leg_s, leg.duration_s, leg.ramp_s) * (leg.to - leg.from);
}

/// Grows from 0 to 1 after the first hold and back before the last, with two continuous derivatives.
double swayEnvelope(double t_s, double duration_s) {
  const double fade_s = std::min(kSwayFade_s, (duration_s - 2 * kShortestEndHold_s) / 3);
  if (fade_s <= 0) return 0.0;
  const double from_end_s = std::min(t_s, duration_s - t_s) - kShortestEndHold_s;
  const double u = std::clamp(from_end_s / fade_s, 0.0, 1.0);
  return u * u * u * (10 - 15 * u + 6 * u * u);
}

Pose poseOf(const Coordinates& c) { return {rotationFromYawPitchRoll(c[3], c[4], c[5]), c.head<3>()}; }

Trajectory sampled(const Plan& plan, const std::string& name) {
  std::vector<double> times_s;
  std::vector<Pose> poses;
  auto leg = plan.legs.begin();
  const auto knots = static_cast<std::size_t>(std::ceil(plan.duration_s / kKnotInterval_s - 1e-9)) + 1;
  for (std::size_t i = 0; i < knots; ++i) {
    const double t_s = kKnotInterval_s * static_cast<double>(i);
    while (leg + 1 != plan.legs.end() && t_s > leg->start_s + leg->duration_s) ++leg;
    Coordinates c = along(*leg, t_s);
    for (const Sway& sway : plan.sways)
      c[sway.axis] += swayEnvelope(t_s, plan.duration_s) * sway.amplitude *
                      std::sin(2 * std::numbers::pi * t_s / sway.period_s + sway.phase);
    times_s.push_back(t_s);
    poses.push_back(poseOf(c));
  }
  return {times_s, poses, name};
}

}  // namespace

Trajectory readWaypoints(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  const Plan plan = readPlan(yaml.root());
  yaml.rejectUnknownKeys();
  return sampled(plan, file.string());
}

}  // namespace fathom
