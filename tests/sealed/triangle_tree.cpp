#include "triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace fathom::sealed {
namespace {

constexpr std::size_t kLeaf = 4;
constexpr std::size_t kDeepest = 64;

Vector3d middleOf(const TriangleTree::Triangle& t) { return (t[0] + t[1] + t[2]) / 3; }

/// Slabs (Kay & Kajiya 1986): where the ray enters the box, if before `limit`.
bool enters(const Eigen::AlignedBox3d& box, const Vector3d& origin, const Vector3d& inverse, double limit) {
  const Eigen::Array3d a = (box.min() - origin).array() * inverse.array();
  const Eigen::Array3d b = (box.max() - origin).array() * inverse.array();
  const double in = std::max(a.min(b).maxCoeff(), 0.0), out = a.max(b).minCoeff();
  return in <= out && in < limit;
}

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles)
    : triangles_(std::move(triangles)), order_(triangles_.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  build(0, order_.size());
}

/// Halves at the median of the longest side, down to a few triangles.
void TriangleTree::build(std::size_t begin, std::size_t end) {
  const std::size_t self = nodes_.size();
  Eigen::AlignedBox3d box, middles;
  for (std::size_t i = begin; i < end; ++i) {
    for (const Vector3d& corner : triangles_[order_[i]]) box.extend(corner);
    middles.extend(middleOf(triangles_[order_[i]]));
  }
  nodes_.push_back({box, begin, end, 0});
  if (end - begin <= kLeaf) return;
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const std::size_t half = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(half), at(end), [&](std::size_t a, std::size_t b) {
    return middleOf(triangles_[a])[axis] < middleOf(triangles_[b])[axis];
  });
  build(begin, half);
  nodes_[self].right = nodes_.size();
  build(half, end);
}

/// Moeller & Trumbore 1997.
void TriangleTree::meet(const Node& leaf, const Vector3d& origin, const Vector3d& direction,
                        std::optional<Hit>& best) const {
  for (std::size_t i = leaf.begin; i < leaf.end; ++i) {
    const Triangle& t = triangles_[order_[i]];
    const Vector3d e1 = t[1] - t[0], e2 = t[2] - t[0], p = direction.cross(e2);
    const double determinant = e1.dot(p);
    if (determinant == 0) continue;
    const Vector3d s = origin - t[0], q = s.cross(e1);
    const double u = s.dot(p) / determinant, v = direction.dot(q) / determinant;
    const double along = e2.dot(q) / determinant;
    if (u < 0 || v < 0 || u + v > 1 || along <= 0 || (best && along >= best->along)) continue;
    best = Hit{along, order_[i], u, v};
  }
}

std::optional<TriangleTree::Hit> TriangleTree::first(const Vector3d& origin,
                                                     const Vector3d& direction) const {
  const Vector3d inverse = direction.cwiseInverse();
  std::optional<Hit> best;
  std::array<std::size_t, kDeepest> open{};
  std::size_t left = nodes_.empty() ? 0 : 1;
  while (left > 0) {
    const std::size_t index = open[--left];
    const Node& node = nodes_[index];
    if (!enters(node.box, origin, inverse, best ? best->along : 1e9)) continue;
    if (node.right == 0) {
      meet(node, origin, direction, best);
    } else {
      open[left++] = node.right;
      open[left++] = index + 1;
    }
  }
  return best;
}

}  // namespace fathom::sealed
