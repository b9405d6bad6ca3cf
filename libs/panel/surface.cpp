#include "panel/surface.h"

namespace fathom {
namespace {

constexpr float kLongestEdge_m = 0.05F;

/// Cuts a triangle's longest edge in two while it is too long: neighbours cut the edge they share alike.
void addCut(const std::array<Surface::Vertex, 3>& corners, Surface& cut) {
  std::size_t longest = 0;
  const auto edge_m = [&](std::size_t i) {
    return (corners[(i + 1) % 3].position - corners[i].position).norm();
  };
  for (const std::size_t i : {1U, 2U})
    if (edge_m(i) > edge_m(longest)) longest = i;
  if (edge_m(longest) <= kLongestEdge_m) {
    const auto first = static_cast<std::uint32_t>(cut.vertices.size());
    cut.vertices.insert(cut.vertices.end(), corners.begin(), corners.end());
    cut.triangles.push_back({first, first + 1, first + 2});
    return;
  }
  const Surface::Vertex &a = corners[longest], &b = corners[(longest + 1) % 3],
                        &c = corners[(longest + 2) % 3];
  const Surface::Vertex middle{0.5F * (a.position + b.position), (a.normal + b.normal).normalized(),
                               0.5F * (a.albedo + b.albedo)};
  addCut({a, middle, c}, cut);
  addCut({middle, b, c}, cut);
}

}  // namespace

Surface shaped(const Surface& surface, const FaceShape<double>& shape, const Eigen::Vector2d& half_extent_m) {
  Surface result;
  for (const auto& [a, b, c] : surface.triangles)
    addCut({surface.vertices[a], surface.vertices[b], surface.vertices[c]}, result);
  for (Surface::Vertex& vertex : result.vertices)
    vertex.position = shape.moved(vertex.position.cast<double>(), half_extent_m).cast<float>();
  return result;
}

void Surface::add(const Surface& other, const Pose& T_a_b) {
  const auto offset = static_cast<std::uint32_t>(vertices.size());
  for (const Vertex& v : other.vertices) {
    // Posed in double: odom coordinates are large beside a millimetre.
    const Vector3d position_a = T_a_b * Vector3d(v.position.cast<double>());
    const Vector3d normal_a = T_a_b.rotation * v.normal.cast<double>();
    vertices.push_back({position_a.cast<float>(), normal_a.cast<float>(), v.albedo});
  }
  for (const auto& [a, b, c] : other.triangles) triangles.push_back({a + offset, b + offset, c + offset});
}

}  // namespace fathom
