#include <algorithm>
#include <cmath>

#include "simulation/trajectory_kinds.h"

namespace fathom {
namespace {

enum class Facing { heading, target, legs };

struct Survey {
  Vector3d target_odom;
  double heading_rad = 0;
  bool upright = true;
  std::vector<double> distances_m;
  double length_m = 0, extent_m = 0, spacing_m = 1;
  Facing facing = Facing::heading;
};

Facing readFacing(const YamlMap& y, bool upright) {
  const std::string facing = y.text("facing");
  if (facing == "heading") return Facing::heading;
  if (facing == "target") return Facing::target;
  if (facing != "legs") throw y.error("facing", "must be heading, target or legs");
  if (upright) throw y.error("facing", "legs goes with plane: level only");
  return Facing::legs;
}

Survey readKeys(const YamlMap& y) {
  Survey survey;
  const YamlMap target = y.map("target");
  const double x = target.number("x"), y_m = target.number("y"), z = target.number("z");
  survey.target_odom = {x, y_m, z};
  survey.heading_rad = radians(y.number("heading_deg"));
  const std::string plane = y.has("plane") ? y.text("plane") : "upright";
  if (plane != "upright" && plane != "level") throw y.error("plane", "must be upright or level");
  survey.upright = plane == "upright";
  survey.distances_m = y.numbers("distances_m");
  if (survey.distances_m.empty() ||
      *std::min_element(survey.distances_m.begin(), survey.distances_m.end()) <= 0)
    throw y.error("distances_m", "must be one distance a sweep, each greater than zero");
  survey.length_m = y.positive("length_m");
  survey.extent_m = y.notNegative("extent_m");
  survey.spacing_m = y.positive("spacing_m");
  if (survey.extent_m / survey.spacing_m > 10'000) throw y.error("spacing_m", "makes more than 10000 legs");
  if (y.has("facing")) survey.facing = readFacing(y, survey.upright);
  return survey;
}

/// Where legs begin and end, in turn, of the sweep at this distance.
std::vector<Vector3d> cornersOf(const Survey& survey, double distance_m) {
  const Vector3d ahead(std::cos(survey.heading_rad), std::sin(survey.heading_rad), 0), up(0, 0, 1);
  const Vector3d left = up.cross(ahead);
  const Vector3d middle = survey.target_odom + distance_m * (survey.upright ? Vector3d(-ahead) : up);
  const Vector3d along = survey.length_m / 2 * (survey.upright ? left : ahead);
  const Vector3d across = survey.extent_m / 2 * (survey.upright ? Vector3d(-up) : left);
  const int gaps = static_cast<int>(std::ceil(survey.extent_m / survey.spacing_m - 1e-9));
  std::vector<Vector3d> corners;
  for (int leg = 0; leg <= gaps; ++leg) {
    const Vector3d centre = middle + (gaps > 0 ? 2.0 * leg / gaps - 1 : 0.0) * across;
    const double way = leg % 2 == 0 ? 1 : -1;
    corners.emplace_back(centre - way * along);
    corners.emplace_back(centre + way * along);
  }
  return corners;
}

/// The one of the equal angles that is the shortest turn from another.
double nearest(double angle_rad, double from_rad) { return from_rad + wrapAngle(angle_rad - from_rad); }

/// Yaw at the end of a move.
double yawAt(const Survey& survey, const Vector3d& from, const Vector3d& to, double before_rad) {
  const Vector3d look =
      survey.facing == Facing::target ? Vector3d(survey.target_odom - to) : Vector3d(to - from);
  const bool is_vertical = look.head<2>().norm() < 1e-6;
  if (survey.facing == Facing::heading) return survey.heading_rad;
  return is_vertical ? before_rad : nearest(std::atan2(look.y(), look.x()), before_rad);
}

Coordinates coordinates(const Vector3d& position, double yaw_rad) {
  Coordinates c = Coordinates::Zero();
  c.head<3>() = position;
  c[3] = yaw_rad;
  return c;
}

}  // namespace

MotionPlan readSurvey(const YamlMap& y) {
  const Survey survey = readKeys(y);
  Pace pace;
  pace.read(y);
  std::vector<Vector3d> path;
  for (std::size_t sweep = 0; sweep < survey.distances_m.size(); ++sweep) {
    auto corners = cornersOf(survey, survey.distances_m[sweep]);
    if (sweep % 2 == 1) std::reverse(corners.begin(), corners.end());
    path.insert(path.end(), corners.begin(), corners.end());
  }

  MotionPlan plan(coordinates(
      path[0],
      yawAt(survey, path[0], survey.facing == Facing::legs ? path[1] : path[0], survey.heading_rad)));
  plan.hold(MotionPlan::kShortestEndHold_s);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double yaw = yawAt(survey, path[i - 1], path[i], plan.here()[3]);
    const auto go = [&](const Coordinates& there) {
      plan.moveTo(there, pace.duration_s(plan.here(), there), pace.ramp_s);
    };
    if (survey.facing == Facing::legs) go(coordinates(path[i - 1], yaw));
    go(coordinates(path[i], yaw));
  }
  plan.hold(MotionPlan::kShortestEndHold_s);
  plan.readSway(y);
  return plan;
}

}  // namespace fathom
