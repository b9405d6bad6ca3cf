#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/geometry.h"

namespace fathom::sealed {

/// Triangles in a tree of boxes, to find the first one that a ray meets.
class TriangleTree {
 public:
  using Triangle = std::array<Vector3d, 3>;
  struct Hit {
    double along = 0;  ///< point = origin + along * direction
    std::size_t triangle = 0;
    double u = 0, v = 0;  ///< barycentric: point = (1 - u - v) t[0] + u t[1] + v t[2]
  };

  explicit TriangleTree(const std::vector<Triangle>& triangles);

  std::optional<Hit> first(const Vector3d& origin, const Vector3d& direction) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::size_t begin, end;  ///< of its triangles in sides_
    std::size_t right;       ///< second child; the first one is the next node. Zero: a leaf
  };
  /// Of a triangle: one corner, and from there to the others.
  struct Sides {
    Vector3d corner, first, second;
    std::size_t triangle;
  };
  void build(const std::vector<Triangle>& triangles, std::size_t begin, std::size_t end);
  void meet(const Node& leaf, const Vector3d& origin, const Vector3d& direction,
            std::optional<Hit>& best) const;

  std::vector<Sides> sides_;  ///< as the leaves have them, one after the other
  std::vector<Node> nodes_;
};

}  // namespace fathom::sealed
