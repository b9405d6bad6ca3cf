#include "panel/surface.h"

namespace fathom {

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
