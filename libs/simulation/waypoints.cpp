#include <algorithm>
#include <stdexcept>

#include "simulation/trajectory_kinds.h"

namespace fathom {
namespace {

/// Time of the leg that ends at this waypoint.
double legDuration_s(const YamlMap& waypoint, const Pace& pace, const MotionPlan& plan,
                     const Coordinates& there) {
  if (!waypoint.has("t_s")) return pace.duration_s(plan.here(), there);
  if (waypoint.has("speed_m_s") || waypoint.has("turn_rate_deg_s"))
    throw waypoint.error("t_s", "cannot be given together with a speed");
  const double leg_s = waypoint.notNegative("t_s") - plan.duration_s();
  if (leg_s < 0 || (leg_s == 0 && there != plan.here()))
    throw waypoint.error("t_s", "must be later than the end of the waypoint before (" +
                                    std::to_string(plan.duration_s()) + " s)");
  return leg_s;
}

}  // namespace

MotionPlan readWaypoints(const YamlMap& y) {
  Pace pace;
  pace.read(y);
  const auto waypoints = y.maps("waypoints");
  if (waypoints.empty()) throw y.error("waypoints", "must have at least one entry");
  MotionPlan plan(readCoordinates(waypoints.front()));
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const YamlMap& waypoint = waypoints[i];
    const Coordinates there = readCoordinates(waypoint);
    Pace leg_pace = pace;
    leg_pace.read(waypoint);
    const bool at_end = i == 0 || i + 1 == waypoints.size();
    const double leg_s = legDuration_s(waypoint, leg_pace, plan, there);
    const double hold_s = waypoint.has("hold_s") ? waypoint.notNegative("hold_s") : 0.0;
    try {
      plan.moveTo(there, leg_s, leg_pace.ramp_s);
      plan.hold(std::max(hold_s, at_end ? MotionPlan::kShortestEndHold_s : 0.0));
    } catch (const std::length_error& too_long) {
      throw waypoint.error("", too_long.what());
    }
  }
  plan.readSway(y);
  return plan;
}

}  // namespace fathom
