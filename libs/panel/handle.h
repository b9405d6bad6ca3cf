#pragma once

#include <string>
#include <string_view>

#include "core/geometry.h"
#include "panel/surface.h"

namespace fathom {

enum class HandleKind { lever, valve, wheel };
std::string_view nameOf(HandleKind kind);

/// A handle turns about the panel's z axis through its position, counter-clockwise seen from in front; at
/// angle 0 it points along the panel's x axis (a wheel: its marked spoke).
struct Handle {
  std::string id;
  HandleKind kind = HandleKind::lever;
  Vector3d position_panel = Vector3d::Zero();  ///< where its axis meets what carries it, m
  double radius_m = 0;                         ///< of its base; of a wheel, its own
  double length_m = 0;                         ///< of its arm or bar, end to end; a wheel's does not matter
  double smallest_angle_rad = 0, largest_angle_rad = 0;
  double angle_rad = 0;  ///< its state; the rest is as built

  Pose T_panel_handle() const;  ///< handle frame: x where it points, z out of the face
};

/// Its shape, handle frame: closed pieces, rounded ones with smooth normals.
Surface surfaceOf(const Handle& handle);
/// How far before its foot the straight edges lie by which its angle is seen: those of its arm, its bar, its
/// marked spoke.
double edgeHeight_m(const Handle& handle);

}  // namespace fathom
