#include "simulation/apparent_scene.h"

#include <optional>

namespace fathom {
namespace {

constexpr double kStraight_px = 0.05;
constexpr double kLongest = 0.3;  // of an edge, in ideal image coordinates: longer ones may bend twice
constexpr double kLongestUnseen_m = 0.3;  // of an edge that leaves what is seen
constexpr int kDeepest = 10;              // divisions of a triangle
constexpr double kNearest_m = 0.02;
constexpr double kWidest = 1.5;  // tangent of the angle to the optical axis, within which things are moved

struct Corner {
  Vector3d true_camera, apparent_camera;
  std::optional<Vector2d> ideal;  // nothing where it is not seen
  Eigen::Vector3f normal, albedo;
};

class Bender {
 public:
  Bender(const Pose& T_odom_camera, const CameraProjector<double>& projector)
      : T_odom_camera_(T_odom_camera),
        T_camera_odom_(T_odom_camera.inverse()),
        projector_(projector),
        straight_(kStraight_px / projector.lens.fx_px),
        nearest_m_(kNearest_m + projector.port.distance_m + projector.port.glass_m) {}

  Corner corner(const Surface::Vertex& vertex) const {
    return at(T_camera_odom_ * vertex.position.cast<double>(), vertex.normal, vertex.albedo);
  }

  /// Divides a triangle at the middles of its bent edges. An edge is judged by its own ends only, so that
  /// neighbours divide it alike.
  void add(const Corner& a, const Corner& b, const Corner& c, int depth, Surface& bent) const {
    const auto ab = middleOfBent(a, b, depth), bc = middleOfBent(b, c, depth), ca = middleOfBent(c, a, depth);
    const int count = ab.has_value() + bc.has_value() + ca.has_value();
    const auto next = [&](const Corner& p, const Corner& q, const Corner& r) {
      add(p, q, r, depth + 1, bent);
    };
    if (count == 0) {
      emit({&a, &b, &c}, bent);
    } else if (count == 3) {
      next(a, *ab, *ca), next(*ab, b, *bc), next(*ca, *bc, c), next(*ab, *bc, *ca);
    } else if (count == 1) {
      if (ab) next(a, *ab, c), next(*ab, b, c);
      if (bc) next(b, *bc, a), next(*bc, c, a);
      if (ca) next(c, *ca, b), next(*ca, a, b);
    } else {
      if (!ab) next(c, *ca, *bc), next(*ca, a, b), next(*ca, b, *bc);
      if (!bc) next(a, *ab, *ca), next(*ab, b, c), next(*ab, c, *ca);
      if (!ca) next(b, *bc, *ab), next(*bc, c, a), next(*bc, a, *ab);
    }
  }

 private:
  Corner at(const Vector3d& point_camera, const Eigen::Vector3f& normal,
            const Eigen::Vector3f& albedo) const {
    Corner corner{point_camera, point_camera, std::nullopt, normal, albedo};
    const double across = point_camera.head<2>().norm();
    if (point_camera.z() < nearest_m_ || across > kWidest * point_camera.z()) return corner;
    corner.ideal = projector_.ideal(point_camera);
    corner.apparent_camera = point_camera.norm() * corner.ideal->homogeneous().normalized();
    return corner;
  }

  /// Nothing where the edge may stay straight.
  std::optional<Corner> middleOfBent(const Corner& a, const Corner& b, int depth) const {
    if (depth == kDeepest || (!a.ideal && !b.ideal)) return std::nullopt;
    const Corner middle = at((a.true_camera + b.true_camera) / 2, (a.normal + b.normal).normalized(),
                             (a.albedo + b.albedo) / 2);
    if (!a.ideal || !b.ideal || !middle.ideal) {
      const bool is_long = (a.true_camera - b.true_camera).norm() > kLongestUnseen_m;
      return is_long ? std::optional(middle) : std::nullopt;
    }
    const Vector2d along = *b.ideal - *a.ideal, off = *middle.ideal - *a.ideal;
    const double length = along.norm();
    const double bend = std::abs(along.x() * off.y() - along.y() * off.x()) / std::max(length, 1e-12);
    return bend > straight_ || length > kLongest ? std::optional(middle) : std::nullopt;
  }

  void emit(const std::array<const Corner*, 3>& corners, Surface& bent) const {
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t i = 0; i < 3; ++i) {
      triangle[i] = static_cast<std::uint32_t>(bent.vertices.size());
      const Vector3d position_odom = T_odom_camera_ * corners[i]->apparent_camera;
      bent.vertices.push_back({position_odom.cast<float>(), corners[i]->normal, corners[i]->albedo});
    }
    bent.triangles.push_back(triangle);
  }

  Pose T_odom_camera_, T_camera_odom_;
  const CameraProjector<double>& projector_;
  double straight_, nearest_m_;
};

}  // namespace

Surface apparentScene(const Surface& scene_odom, const Pose& T_odom_camera,
                      const CameraProjector<double>& projector) {
  const Bender bender(T_odom_camera, projector);
  Surface bent;
  for (const auto& [i, j, k] : scene_odom.triangles)
    bender.add(bender.corner(scene_odom.vertices[i]), bender.corner(scene_odom.vertices[j]),
               bender.corner(scene_odom.vertices[k]), 0, bent);
  return bent;
}

}  // namespace fathom
