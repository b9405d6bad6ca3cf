#include "render/faces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace fathom {
namespace {

using Corners = std::array<std::uint32_t, 3>;
using Plane = std::array<float, 4>;  // normal, offset in 10 um
using PlaneAndAlbedo = std::array<float, 7>;

/// Disjoint sets of numbers, each named after its least.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t nameOf(std::uint32_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void join(std::uint32_t j, std::uint32_t k) {
    const auto a = nameOf(j), b = nameOf(k);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Whether the triangle lies in one plane with its normals, and in which.
bool findPlane(const Surface& surface, const Corners& corners, Plane& plane) {
  const Eigen::Vector3f& normal = surface.vertices[corners[0]].normal;
  std::array<double, 3> offsets{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& vertex = surface.vertices[corners[i]];
    if (vertex.normal != normal) return false;
    offsets[i] = std::round(1e5 * normal.cast<double>().dot(vertex.position.cast<double>()));
  }
  plane = {normal.x(), normal.y(), normal.z(), static_cast<float>(offsets[0])};
  return offsets[0] == offsets[1] && offsets[0] == offsets[2];
}

}  // namespace

bool isUniform(const Surface& surface, std::size_t triangle) {
  const auto& [i, j, k] = surface.triangles[triangle];
  const auto &a = surface.vertices[i], &b = surface.vertices[j], &c = surface.vertices[k];
  return a.normal == b.normal && a.normal == c.normal && a.albedo == b.albedo && a.albedo == c.albedo;
}

std::vector<std::uint32_t> facesOf(const Surface& surface) {
  Sets faces(surface.triangles.size() + 1);
  std::map<PlaneAndAlbedo, std::uint32_t> first_alike;
  constexpr std::uint32_t kNone = 0;
  std::vector<std::uint32_t> first_at_vertex(surface.vertices.size(), kNone);
  for (std::uint32_t k = 1; k <= surface.triangles.size(); ++k) {
    const Corners& corners = surface.triangles[k - 1];
    Plane plane{};
    if (!findPlane(surface, corners, plane)) continue;
    if (isUniform(surface, k - 1)) {
      const Eigen::Vector3f& albedo = surface.vertices[corners[0]].albedo;
      const PlaneAndAlbedo key{plane[0], plane[1], plane[2], plane[3], albedo.x(), albedo.y(), albedo.z()};
      faces.join(k, first_alike.emplace(key, k).first->second);
    }
    for (const std::uint32_t vertex : corners) {
      if (first_at_vertex[vertex] == kNone) first_at_vertex[vertex] = k;
      faces.join(k, first_at_vertex[vertex]);
    }
  }
  std::vector<std::uint32_t> face_of(surface.triangles.size() + 1);
  for (std::uint32_t k = 0; k < face_of.size(); ++k) face_of[k] = faces.nameOf(k);
  return face_of;
}

}  // namespace fathom
