#pragma once

#include <optional>

#include "core/geometry.h"
#include "sealed_case.h"
#include "vehicle.h"

/// The true camera: a lens that distorts, behind a flat window or a dome. Camera frame: x right, y down, z
/// forward; pixel (0, 0) is the centre of the top left pixel.
namespace fathom::sealed {

using Eigen::Vector2d;

/// A line of sight in the water.
struct Ray {
  Vector3d origin, direction;  ///< direction of unit length

  /// Where it crosses the plane z = height.
  Vector3d atHeight(double height) const {
    return origin + direction * ((height - origin.z()) / direction.z());
  }
};

/// Snell's law for vectors: a unit direction passes from index n1 to n2 through a surface whose unit normal
/// points along with it (e.g. Glassner 1989, ch. 4, Heckbert's form). Not past the critical angle.
Vector3d refracted(const Vector3d& direction, const Vector3d& normal, double n1_over_n2);

class TrueCamera {
 public:
  /// As it is at that time.
  TrueCamera(const Camera& nominal, const SealedCase& sealed, double t_s);

  /// From the camera's centre through air, glass and water.
  Ray rayAt(const Vector2d& pixel) const { return rayAlong(idealAt(pixel)); }
  /// Nothing where the point is behind the camera, or far beside what it sees.
  std::optional<Vector2d> pixelOf(const Vector3d& point_camera) const;

 private:
  Vector2d idealAt(const Vector2d& pixel) const;
  Vector2d distorted(const Vector2d& ideal) const;
  Vector2d pixelAt(const Vector2d& ideal) const;
  Ray rayAlong(const Vector2d& ideal) const;
  Ray throughDome(const Vector3d& direction) const;

  Camera camera_;  ///< with its true focal length and distortion
  bool has_port_;
  double distance_m_, glass_m_, intrinsics_index_;
  Vector3d normal_;
  bool has_dome_;
  double dome_outer_m_, dome_inner_m_;
  Vector3d dome_centre_;
};

}  // namespace fathom::sealed
