#include "panel/handle.h"

#include <numbers>

/// Handles as lathe work and bars. Handle frame: x where the handle points, z out of the face.
namespace fathom {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

// Linear albedo of what handles are made of.
const Vector3f kOrange{0.66f, 0.26f, 0.07f};  // what the hand holds
const Vector3f kSteel{0.38f, 0.38f, 0.40f};
const Vector3f kDark{0.10f, 0.10f, 0.11f};

// Heights before the foot, m.
constexpr double kLeverTop = 0.048, kValveTop = 0.075, kMarkedSpokeTop = 0.062;

constexpr int kSides = 24;  // of what is round
constexpr int kRimSides = 8;

struct Box {
  Vector3d smallest, largest;
};

void addBox(const Box& box, const Vector3f& albedo, Surface& surface) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      Vector3d corner = side > 0 ? box.largest : box.smallest;
      const auto first = static_cast<std::uint32_t>(surface.vertices.size());
      for (const auto& [at_u, at_v] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
        corner[u] = at_u != 0 ? box.largest[u] : box.smallest[u];
        corner[v] = at_v != 0 ? box.largest[v] : box.smallest[v];
        surface.vertices.push_back({corner.cast<float>(), side * Vector3f::Unit(axis), albedo});
      }
      if (side > 0)
        surface.triangles.insert(surface.triangles.end(),
                                 {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
      else
        surface.triangles.insert(surface.triangles.end(),
                                 {{first, first + 2, first + 1}, {first, first + 3, first + 2}});
    }
}

/// What a profile (radius, z) sweeps when it turns about the z axis. `normals` go with the profile's points;
/// outside is to the right of its way.
void addSwept(const std::vector<Vector2d>& profile, const std::vector<Vector2d>& normals,
              const Vector3f& albedo, Surface& surface) {
  const auto first = static_cast<std::uint32_t>(surface.vertices.size());
  const auto points = static_cast<std::uint32_t>(profile.size());
  for (int side = 0; side < kSides; ++side) {
    const double angle = 2.0 * std::numbers::pi * side / kSides, c = std::cos(angle), s = std::sin(angle);
    for (std::size_t i = 0; i < profile.size(); ++i)
      surface.vertices.push_back(
          {Vector3d(c * profile[i].x(), s * profile[i].x(), profile[i].y()).cast<float>(),
           Vector3d(c * normals[i].x(), s * normals[i].x(), normals[i].y()).cast<float>(), albedo});
  }
  for (std::uint32_t side = 0; side < kSides; ++side)
    for (std::uint32_t i = 0; i + 1 < points; ++i) {
      const std::uint32_t a = first + side * points + i, b = first + (side + 1) % kSides * points + i;
      const bool from_axis = profile[i].x() == 0.0, to_axis = profile[i + 1].x() == 0.0;
      if (!from_axis) surface.triangles.push_back({a, b, b + 1});
      if (!to_axis) surface.triangles.push_back({a, b + 1, a + 1});
    }
}

struct Cylinder {
  double radius_m, bottom_m, top_m;
};

void addCylinder(const Cylinder& c, const Vector3f& albedo, Surface& surface) {
  const Vector2d down(0, -1), out(1, 0), up(0, 1);
  addSwept({{0, c.bottom_m}, {c.radius_m, c.bottom_m}}, {down, down}, albedo, surface);
  addSwept({{c.radius_m, c.bottom_m}, {c.radius_m, c.top_m}}, {out, out}, albedo, surface);
  addSwept({{c.radius_m, c.top_m}, {0, c.top_m}}, {up, up}, albedo, surface);
}

/// A ring of round section; radius_m is its outermost.
void addRing(double radius_m, double section_m, double middle_z_m, const Vector3f& albedo, Surface& surface) {
  std::vector<Vector2d> profile, normals;
  for (int i = 0; i <= kRimSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i % kRimSides) / kRimSides;
    normals.emplace_back(std::cos(angle), std::sin(angle));
    profile.emplace_back(Vector2d(radius_m - section_m, middle_z_m) + section_m * normals.back());
  }
  addSwept(profile, normals, albedo, surface);
}

/// A bar along x from the face's point of view, between two heights.
Box bar(double from_x, double to_x, double half_width, double bottom, double top) {
  return {{from_x, -half_width, bottom}, {to_x, half_width, top}};
}

/// A hub, and on it an arm, most of which is on the side it points to.
Surface leverShape(double radius_m, double length_m) {
  Surface shape;
  addCylinder({0.6 * radius_m, 0.0, 0.030}, kSteel, shape);
  addBox(bar(-0.1 * length_m, 0.9 * length_m, 0.11 * length_m, 0.030, kLeverTop), kOrange, shape);
  return shape;
}

/// A disc, a stem, and across it a bar: its two ends are alike.
Surface valveShape(double radius_m, double length_m) {
  Surface shape;
  addCylinder({radius_m, 0.0, 0.012}, kSteel, shape);
  addCylinder({0.375 * radius_m, 0.012, 0.055}, kDark, shape);
  addBox(bar(-0.5 * length_m, 0.5 * length_m, 0.1 * length_m, 0.055, kValveTop), kOrange, shape);
  return shape;
}

/// A rim on four spokes. The one it points with is broad, of bare steel, and carries a knob.
Surface wheelShape(double radius_m) {
  const double section_m = 0.13 * radius_m, hub_m = 0.33 * radius_m;
  constexpr double kRim_m = 0.049;  // height of the rim's middle
  Surface shape;
  addCylinder({hub_m, 0.0, 0.055}, kDark, shape);
  addRing(radius_m, section_m, kRim_m, kOrange, shape);
  for (int quarter = 1; quarter < 4; ++quarter) {
    Surface spoke;
    addBox(bar(0.5 * hub_m, radius_m - section_m, 0.08 * radius_m, kRim_m - 0.004, kRim_m + 0.004), kOrange,
           spoke);
    shape.add(spoke, {rotationFromYawPitchRoll(quarter * radians(90), 0, 0), Vector3d::Zero()});
  }
  addBox(bar(0.0, radius_m - section_m, 0.14 * radius_m, kRim_m, kMarkedSpokeTop), kSteel, shape);
  Surface knob;
  addCylinder({0.16 * radius_m, kRim_m, 0.075}, kSteel, knob);
  shape.add(knob, {Matrix3d::Identity(), Vector3d(radius_m - section_m, 0, 0)});
  return shape;
}

}  // namespace

Pose Handle::T_panel_handle() const { return {rotationFromYawPitchRoll(angle_rad, 0, 0), position_panel}; }

Surface surfaceOf(const Handle& handle) {
  switch (handle.kind) {
    case HandleKind::lever:
      return leverShape(handle.radius_m, handle.length_m);
    case HandleKind::valve:
      return valveShape(handle.radius_m, handle.length_m);
    case HandleKind::wheel:
      return wheelShape(handle.radius_m);
  }
  return {};
}

double edgeHeight_m(const Handle& handle) {
  switch (handle.kind) {
    case HandleKind::lever:
      return kLeverTop;
    case HandleKind::valve:
      return kValveTop;
    case HandleKind::wheel:
      return kMarkedSpokeTop;
  }
  return 0;
}

std::string_view nameOf(HandleKind kind) {
  switch (kind) {
    case HandleKind::lever:
      return "lever";
    case HandleKind::valve:
      return "valve";
    case HandleKind::wheel:
      return "wheel";
  }
  return "";
}

}  // namespace fathom
