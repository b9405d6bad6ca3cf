#pragma once

#include <cmath>

#include "core/geometry.h"

namespace fathom {

/// How a panel's face differs from the flat one of its map. Panel frame: the origin is the middle of the
/// face, x right, y up, z out of it. All zero: as mapped.
template <class T>
struct FaceShape {
  T stretch_x{0}, stretch_y{0};  ///< true / mapped - 1, along x and along y
  T shear{0};                    ///< by how much x grows with y
  T fold_rad{0};  ///< between the two halves, about the vertical middle line; positive: their edges come
                  ///< forward
  T twist_m{0};   ///< height of the top right and bottom left corners; the other two are as much behind
  T bend_m{0};    ///< height of the middle over the corners, of a paraboloid

  /// Where a point of the map truly is; what stands before the face moves with it. `half_extent_m`: from the
  /// middle of the face to its edges, right and up.
  Vector3<T> moved(const Vector3<T>& point_panel, const Eigen::Vector2d& half_extent_m) const {
    using std::abs, std::cos, std::sin;
    const T right = point_panel.x() / (half_extent_m.x() > 0 ? half_extent_m.x() : 1.0),
            up = point_panel.y() / (half_extent_m.y() > 0 ? half_extent_m.y() : 1.0);
    const T x = (1.0 + stretch_x) * point_panel.x() + shear * point_panel.y(),
            y = (1.0 + stretch_y) * point_panel.y();
    const T height = twist_m * right * up + bend_m * (1.0 - 0.5 * (right * right + up * up));
    const T half_angle = 0.5 * fold_rad;
    return {x * cos(half_angle), y, point_panel.z() + abs(x) * sin(half_angle) + height};
  }
};

/// Whether it is as mapped.
inline bool isAsMapped(const FaceShape<double>& s) {
  return s.stretch_x == 0 && s.stretch_y == 0 && s.shear == 0 && s.fold_rad == 0 && s.twist_m == 0 &&
         s.bend_m == 0;
}

}  // namespace fathom
