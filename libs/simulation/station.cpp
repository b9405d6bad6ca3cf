#include "simulation/trajectory_kinds.h"

namespace fathom {

MotionPlan readStation(const YamlMap& y) {
  const double duration_s = y.positive("duration_s");
  if (duration_s < 2 * MotionPlan::kShortestEndHold_s) throw y.error("duration_s", "must be at least 4 s");
  MotionPlan plan(readCoordinates(y.map("pose")));
  plan.hold(duration_s);
  plan.readSway(y);
  return plan;
}

}  // namespace fathom
