#pragma once

#include "audit/checks.h"
#include "audit/regression.h"

namespace fathom {

/// The way up that the pressure says (y, m) over the way up by a DVL's velocity (x), steps of
/// kVerticalStep_s: slope 1 where both are right. Up is where the INS's specific force points. `dvl_axes`,
/// `ins_axes`: what their own are taken for.
Regression verticalEvidence(const DvlStream& dvl, const InsStream& ins, const DepthStream& depth,
                            const Vehicle& vehicle, const Matrix3d& dvl_axes = Matrix3d::Identity(),
                            const Matrix3d& ins_axes = Matrix3d::Identity());
/// The same by the first INS and DVL; empty where there is none, or one is already found to be wrong.
Regression verticalEvidence(const Streams& streams, const DepthStream& depth, const Vehicle& vehicle,
                            const std::vector<Finding>& findings);
inline constexpr double kVerticalStep_s = 4;

}  // namespace fathom
