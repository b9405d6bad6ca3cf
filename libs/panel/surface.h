#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/face_shape.h"
#include "core/geometry.h"

namespace fathom {

/// Matt triangles. Vertices are not shared between faces of different normal or colour.
struct Surface {
  struct Vertex {
    Eigen::Vector3f position;  ///< m
    Eigen::Vector3f normal;    ///< unit length, out of the body
    Eigen::Vector3f albedo;    ///< linear red, green, blue
  };
  std::vector<Vertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside

  /// Appends another surface, given in frame b, to this one, in frame a.
  void add(const Surface& other, const Pose& T_a_b = {});
};

/// A panel's surface, panel frame, as its face is shaped: cut until no edge is longer than 5 cm, then moved
/// corner by corner (FaceShape::moved()). Normals stay.
Surface shaped(const Surface& surface, const FaceShape<double>& shape, const Eigen::Vector2d& half_extent_m);

}  // namespace fathom
