#pragma once

#include <vector>

#include "estimation/batch_data.h"

namespace fathom {

/// What the sensors of a recording would read along other poses (T_odom_robot, every knot_s): when, of what,
/// how exactly. Not what: for Jacobians, which ask where markers and patches are in the picture but not what
/// was read. `effects`: those that are known to be there, a port before all. An image a second, of what the
/// recording's images show: all markers of the panels, the places whose light it has, open water where it was
/// seen in the picture.
BatchData readingsAlong(const BatchData& recording, const std::vector<double>& times_s,
                        const std::vector<Pose>& poses, const EffectParameters<double>& effects);

}  // namespace fathom
