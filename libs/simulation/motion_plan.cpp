#include "simulation/motion_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/random.h"

namespace fathom {
namespace {

constexpr std::array<const char*, 6> kAxes{"x", "y", "z", "yaw", "pitch", "roll"};
constexpr double kKnotInterval_s = 0.2;  // ten knots in the end holds: a spline forgets its end by 3.7 a knot
constexpr double kSwayFade_s = 8.0;
constexpr double kLongest_s = 30 * 86400.0;

/// Share of a leg that is done: speed rises and falls as half a cosine, so acceleration is continuous.
double progress(double t_s, double duration_s, double ramp_s) {
  using std::numbers::pi;
  const double top_speed = 1.0 / (duration_s - ramp_s);
  const auto ramp = [&](double t) { return top_speed * (t - ramp_s / pi * std::sin(pi * t / ramp_s)) / 2; };
  if (t_s < ramp_s) return ramp(t_s);
  if (t_s > duration_s - ramp_s) return 1.0 - ramp(duration_s - t_s);
  return top_speed * (t_s - ramp_s / 2);
}

/// Grows from 0 to 1 after the first hold and back before the last, with two continuous derivatives.
double swayEnvelope(double t_s, double duration_s) {
  const double hold_s = MotionPlan::kShortestEndHold_s;
  const double fade_s = std::min(kSwayFade_s, (duration_s - 2 * hold_s) / 3);
  if (fade_s <= 0) return 0.0;
  const double from_end_s = std::min(t_s, duration_s - t_s) - hold_s;
  const double u = std::clamp(from_end_s / fade_s, 0.0, 1.0);
  return u * u * u * (10 - 15 * u + 6 * u * u);
}

}  // namespace

Coordinates readCoordinates(const YamlMap& y) {
  const auto angle = [&](const std::string& key) { return y.has(key) ? radians(y.number(key)) : 0.0; };
  // All read first: Eigen's comma initializer asserts where an exception cuts it short.
  const std::array<double, 6> values{y.number("x"),      y.number("y"),
                                     y.number("z"),      radians(y.number("yaw_deg")),
                                     angle("pitch_deg"), angle("roll_deg")};
  return Coordinates(values.data());
}

void Pace::read(const YamlMap& y) {
  if (y.has("speed_m_s")) speed_m_s = y.positive("speed_m_s");
  if (y.has("turn_rate_deg_s")) turn_rate_rad_s = radians(y.positive("turn_rate_deg_s"));
  if (y.has("ramp_s")) ramp_s = y.positive("ramp_s");
}

double Pace::duration_s(const Coordinates& from, const Coordinates& to) const {
  const double way_s = (to - from).head<3>().norm() / speed_m_s;
  const double turn_s = (to - from).tail<3>().cwiseAbs().maxCoeff() / turn_rate_rad_s;
  const double cruise_s = std::max(way_s, turn_s);
  // A leg of length L at speed v with ramps r takes L/v + r; a short one is all ramp.
  return cruise_s > 0 ? std::max(cruise_s + ramp_s, 2 * ramp_s) : 0.0;
}

void MotionPlan::moveTo(const Coordinates& there, double duration_s, double ramp_s) {
  if (duration_s <= 0) return;
  legs_.push_back({duration_s_, duration_s, std::min(ramp_s, duration_s / 2), here_, there});
  duration_s_ += duration_s;
  here_ = there;
  if (duration_s_ > kLongest_s) throw std::length_error("the trajectory lasts more than 30 days");
}

Coordinates MotionPlan::Leg::at(double t_s) const {
  if (from == to) return from;
  const double in_leg_s = std::clamp(t_s - start_s, 0.0, duration_s);
  return from + progress(in_leg_s, duration_s, ramp_s) * (to - from);
}

MotionPlan::Sway MotionPlan::readOneSway(const YamlMap& y, double phase) {
  Sway sway;
  const std::string axis = y.text("axis");
  const auto found = std::find(kAxes.begin(), kAxes.end(), axis);
  if (found == kAxes.end()) throw y.error("axis", "must be x, y, z, yaw, pitch or roll");
  sway.axis = static_cast<int>(found - kAxes.begin());
  sway.amplitude = sway.axis < 3 ? y.number("amplitude_m") : radians(y.number("amplitude_deg"));
  sway.period_s = y.positive("period_s");
  if (sway.period_s < 4 * kKnotInterval_s) throw y.error("period_s", "must be at least 0.8 s");
  sway.phase = y.has("phase_deg") ? radians(y.number("phase_deg")) : phase;
  return sway;
}

void MotionPlan::readSway(const YamlMap& y) {
  std::optional<Random> random;
  if (y.has("sway_seed")) random.emplace(static_cast<std::uint64_t>(y.integer("sway_seed")));
  if (!y.has("sway")) return;
  for (const YamlMap& sway : y.maps("sway"))
    sways_.push_back(readOneSway(sway, random ? random->uniform(0, 2 * std::numbers::pi) : 0.0));
}

Trajectory MotionPlan::trajectory(const std::string& name) const {
  std::vector<double> times_s;
  std::vector<Pose> poses;
  auto leg = legs_.begin();
  const auto knots = static_cast<std::size_t>(std::ceil(duration_s_ / kKnotInterval_s - 1e-9)) + 1;
  for (std::size_t i = 0; i < knots; ++i) {
    const double t_s = kKnotInterval_s * static_cast<double>(i);
    while (leg + 1 != legs_.end() && t_s > leg->start_s + leg->duration_s) ++leg;
    Coordinates c = leg->at(t_s);
    for (const Sway& sway : sways_)
      c[sway.axis] += swayEnvelope(t_s, duration_s_) * sway.amplitude *
                      std::sin(2 * std::numbers::pi * t_s / sway.period_s + sway.phase);
    times_s.push_back(t_s);
    poses.push_back({rotationFromYawPitchRoll(c[3], c[4], c[5]), c.head<3>()});
  }
  return {times_s, poses, name};
}

}  // namespace fathom
