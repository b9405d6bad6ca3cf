#include "triangle_tree.h"

#include <algorithm>

namespace fathom::sealed {
namespace {

constexpr std::size_t kLeaf = 4;
constexpr std::size_t kDeepest = 64;

Vector3d middleOf(const TriangleTree::Triangle& t) { return (t[0] + t[1] + t[2]) / 3; }

/// Slabs (Kay & Kajiya 1986): how far along the ray enters the box; nothing where it does not.
std::optional<double> entry(const Eigen::AlignedBox3d& box, const Vector3d& origin, const Vector3d& inverse) {
  const Eigen::Array3d a = (box.min() - origin).array() * inverse.array();
  const Eigen::Array3d b = (box.max() - origin).array() * inverse.array();
  const double in = std::max(a.min(b).maxCoeff(), 0.0), out = a.max(b).minCoeff();
  if (in <= out) return in;
  return {};
}

}  // namespace

TriangleTree::TriangleTree(const std::vector<Triangle>& triangles) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    sides_.push_back({t[0], t[1] - t[0], t[2] - t[0], i});
  }
  build(triangles, 0, sides_.size());
}

/// Halves at the median of the longest side, down to a few triangles.
void TriangleTree::build(const std::vector<Triangle>& triangles, std::size_t begin, std::size_t end) {
  const auto middle = [&](const Sides& sides) { return middleOf(triangles[sides.triangle]); };
  const std::size_t self = nodes_.size();
  Eigen::AlignedBox3d box, middles;
  for (std::size_t i = begin; i < end; ++i) {
    for (const Vector3d& corner : triangles[sides_[i].triangle]) box.extend(corner);
    middles.extend(middle(sides_[i]));
  }
  nodes_.push_back({box, begin, end, 0});
  if (end - begin <= kLeaf) return;
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const std::size_t half = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return sides_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(half), at(end),
                   [&](const Sides& a, const Sides& b) { return middle(a)[axis] < middle(b)[axis]; });
  build(triangles, begin, half);
  nodes_[self].right = nodes_.size();
  build(triangles, half, end);
}

/// Moeller & Trumbore 1997.
void TriangleTree::meet(const Node& leaf, const Vector3d& origin, const Vector3d& direction,
                        std::optional<Hit>& best) const {
  for (std::size_t i = leaf.begin; i < leaf.end; ++i) {
    const Sides& sides = sides_[i];
    const Vector3d p = direction.cross(sides.second);
    const double determinant = sides.first.dot(p);
    if (determinant == 0) continue;
    const Vector3d s = origin - sides.corner;
    const double u = s.dot(p) / determinant;
    if (u < 0 || u > 1) continue;
    const Vector3d q = s.cross(sides.first);
    const double v = direction.dot(q) / determinant;
    if (v < 0 || u + v > 1) continue;
    const double along = sides.second.dot(q) / determinant;
    if (along <= 0 || (best && along >= best->along)) continue;
    best = Hit{along, sides.triangle, u, v};
  }
}

/// Nearer boxes first: most of the farther ones then need no look.
std::optional<TriangleTree::Hit> TriangleTree::first(const Vector3d& origin,
                                                     const Vector3d& direction) const {
  struct Open {
    double in;
    std::size_t node;
  };
  const Vector3d inverse = direction.cwiseInverse();
  std::optional<Hit> best;
  std::array<Open, kDeepest> open;
  std::size_t left = 0;
  const auto entryOf = [&](std::size_t node) { return entry(nodes_[node].box, origin, inverse); };
  if (const auto in = entryOf(0)) open[left++] = {*in, 0};
  while (left > 0) {
    const Open next = open[--left];
    if (best && next.in >= best->along) continue;
    const Node& node = nodes_[next.node];
    if (node.right == 0) {
      meet(node, origin, direction, best);
      continue;
    }
    std::size_t near = next.node + 1, far = node.right;
    auto in_near = entryOf(near), in_far = entryOf(far);
    if (in_near && in_far && *in_far < *in_near) {
      std::swap(near, far);
      std::swap(in_near, in_far);
    }
    if (in_far) open[left++] = {*in_far, far};
    if (in_near) open[left++] = {*in_near, near};
  }
  return best;
}

}  // namespace fathom::sealed
