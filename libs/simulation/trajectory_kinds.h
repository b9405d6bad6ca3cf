#pragma once

#include "simulation/motion_plan.h"

/// The kinds of trajectory files that are plans; their keys stand in read_trajectory.h. All throw Error.
namespace fathom {

MotionPlan readWaypoints(const YamlMap& y);
MotionPlan readStation(const YamlMap& y);
MotionPlan readSurvey(const YamlMap& y);

}  // namespace fathom
