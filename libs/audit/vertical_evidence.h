#pragma once

#include "audit/checks.h"
#include "audit/regression.h"
#include "recording/axes.h"

namespace fathom {

/// The way up that the pressure says (y, m) over the way up by the first DVL's velocity (x), steps of
/// kVerticalStep_s: slope 1 where both are right. Up is where the INS's specific force points. `dvl_axes`,
/// `ins_axes`: what their own are taken for. Empty where there is no DVL.
Regression verticalEvidence(const Streams& streams, const InsStream& ins, const DepthStream& depth,
                            const Vehicle& vehicle, const SignedAxes& dvl_axes = {},
                            const SignedAxes& ins_axes = {});
/// The same by the first INS; empty, too, where it or the DVL is already found to be wrong.
Regression verticalEvidence(const Streams& streams, const DepthStream& depth, const Vehicle& vehicle,
                            const std::vector<Finding>& findings, const SignedAxes& dvl_axes = {});
inline constexpr double kVerticalStep_s = 4;

}  // namespace fathom
