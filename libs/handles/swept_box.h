#pragma once

#include <array>
#include <optional>
#include <vector>

#include "panel/panel_map.h"

/// What the panel map alone says of how a handle can look. Foot frame of a handle: its position on the panel,
/// the panel's axes; the handle's state does not turn it.
namespace fathom {

/// The upright box in which a handle is whatever its angle; foot frame, m.
struct SweptBox {
  double reach_m = 0;  ///< |x| and |y| are at most this
  double top_m = 0;    ///< z is between 0 and this

  std::array<Vector3d, 8> corners() const;
  /// Of the cylinder in it that the handle never leaves: points around its bottom and its top.
  std::vector<Vector3d> rims() const;
};
SweptBox sweptBoxOf(const Handle& handle);

/// How large it looks from far in front, m2.
double silhouette_m2(const Handle& handle);

/// After which angle a handle looks the same: its bar's two ends are alike, a lever's and a wheel's marked
/// spoke are not. rad
double symmetryOf(HandleKind kind);
/// The same of its straight edges alone: those of a wheel's four spokes, of a lever's two sides. rad
double symmetryOfEdges(HandleKind kind);

/// The smallest difference a - b that symmetry leaves, rad.
double angleDifference(double a_rad, double b_rad, double symmetry_rad);

/// All angles within the handle's range, and this much beyond its ends, that look like this one, smallest
/// first.
std::vector<double> anglesInRange(const Handle& handle, double angle_rad, double symmetry_rad,
                                  double beyond_rad = 0);

}  // namespace fathom
