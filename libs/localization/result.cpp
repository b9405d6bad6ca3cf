#include "localization/result.h"

namespace fathom {

YawPitchRollPose posePdf(const Estimate& estimate) {
  const auto& motion = estimate.state.motion;
  return UncertainPose{{motion.R_odom_robot, motion.position_odom}, estimate.pose_covariance}
      .toYawPitchRoll();
}

}  // namespace fathom
