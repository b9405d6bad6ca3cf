#pragma once

#include <limits>
#include <vector>

#include "core/camera_model.h"
#include "render/renderer.h"

/// The renderer's reference: every triangle tried for every ray, in double (Moller & Trumbore 1997).
namespace fathom::test {

struct Hit {
  double range_m = std::numeric_limits<double>::infinity();
  std::size_t triangle = 0;
  Vector3d shares;         ///< of the triangle's corners
  double edge_margin = 0;  ///< smallest of the shares

  explicit operator bool() const { return range_m < std::numeric_limits<double>::infinity(); }
};

Hit castRay(const Surface& surface, const Vector3d& from_odom, const Vector3d& direction_odom);

Hit castRay(const Surface& surface, const CameraModel& camera, const Pose& T_odom_camera,
            const Vector2d& pixel);

/// Red, green, blue as the header of the renderer says.
Vector3d lightOf(const Hit& hit, const Surface& surface, const Lighting& lighting, const Vector3d& from_odom,
                 const Vector3d& direction_odom);

}  // namespace fathom::test
