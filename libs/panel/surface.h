#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

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

}  // namespace fathom
