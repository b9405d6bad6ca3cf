#pragma once

#include "core/geometry.h"

namespace fathom {

/// The odom frame put elsewhere, upright as before: what is known of a pose in the old one is known in the
/// new one, but for how far and by how much it was moved.
struct FrameMove {
  Pose T_new_old;                                   ///< a turn about z, and a shift
  Vector3d pivot_new = Vector3d::Zero();            ///< what the turn's uncertainty is about
  Eigen::Vector4d sigma = Eigen::Vector4d::Zero();  ///< of the shift (m, three axes) and the turn (rad)

  /// This one after an earlier one, of which it is not known better where the frame is.
  FrameMove after(const FrameMove& earlier) const {
    return {T_new_old * earlier.T_new_old, pivot_new, sigma.cwiseMax(earlier.sigma)};
  }
};

}  // namespace fathom
