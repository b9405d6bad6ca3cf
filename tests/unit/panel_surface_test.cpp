// What is drawn of a panel: closed, turned outwards, and where the map says.
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "panel/marker_family.h"
#include "support/panels.h"

namespace fathom {
namespace {
using Eigen::Vector3f;
using Triple = std::array<float, 3>;

Triple key(const Vector3f& p) { return {p.x() + 0.0f, p.y() + 0.0f, p.z() + 0.0f}; }

Vector3d corner(const Surface& s, const std::array<std::uint32_t, 3>& t, std::size_t i) {
  return s.vertices[t[i]].position.cast<double>();
}

Vector3d twiceArea(const Surface& s, const std::array<std::uint32_t, 3>& t) {
  return (corner(s, t, 1) - corner(s, t, 0)).cross(corner(s, t, 2) - corner(s, t, 0));
}

double volume_m3(const Surface& s) {
  double volume = 0.0;
  for (const auto& t : s.triangles)
    volume += corner(s, t, 0).dot(corner(s, t, 1).cross(corner(s, t, 2))) / 6.0;
  return volume;
}

/// Every edge is used once in each direction; vertices are welded by place.
void expectClosed(const Surface& s) {
  std::map<std::pair<Triple, Triple>, int> uses;
  for (const auto& t : s.triangles)
    for (std::size_t i = 0; i < 3; ++i)
      ++uses[{key(s.vertices[t[i]].position), key(s.vertices[t[(i + 1) % 3]].position)}];
  for (const auto& [edge, count] : uses) {
    const auto back = uses.find({edge.second, edge.first});
    ASSERT_TRUE(back != uses.end() && back->second == count)
        << "open edge at " << edge.first[0] << " " << edge.first[1] << " " << edge.first[2];
  }
}

/// Vertex normals are unit vectors within a facet's angle of the triangle's own; no triangle is empty.
void expectNormalsOutwards(const Surface& s) {
  for (const auto& t : s.triangles) {
    const Vector3d n = twiceArea(s, t);
    ASSERT_GT(n.norm(), 1e-10);
    for (const auto v : t) {
      EXPECT_NEAR(s.vertices[v].normal.norm(), 1.0f, 1e-5f);
      EXPECT_GT(n.normalized().dot(s.vertices[v].normal.cast<double>()), 0.85);
    }
  }
}

Handle handle(HandleKind kind) {
  Handle h;
  h.id = "X";
  h.kind = kind;
  h.radius_m = 0.06;
  h.length_m = 0.12;
  h.largest_angle_rad = 6;
  return h;
}

TEST(PanelSurface, HandlesAreClosedAndTurnedOutwards) {
  for (const auto kind : {HandleKind::lever, HandleKind::valve, HandleKind::wheel}) {
    SCOPED_TRACE(nameOf(kind));
    const Surface shape = surfaceOf(handle(kind));
    expectClosed(shape);
    expectNormalsOutwards(shape);
    EXPECT_GT(volume_m3(shape), 0.0);
    EXPECT_LT(shape.triangles.size(), 1200U);
    for (const auto& v : shape.vertices) {
      EXPECT_GE(v.position.z(), 0.0f);
      EXPECT_LE(v.position.z(), 0.08f);
      EXPECT_LE(v.position.head<2>().norm(), 0.12f);
    }
  }
}

TEST(PanelSurface, LeverHasTheVolumeOfItsParts) {
  // A prism of 24 sides in a circle of 0.6 * 60 mm, 30 mm high, and a bar of 120 x 26.4 x 18 mm.
  const double sides = 24, radius = 0.036;
  const double hub = sides / 2 * radius * radius * std::sin(2 * std::numbers::pi / sides) * 0.030;
  EXPECT_NEAR(volume_m3(surfaceOf(handle(HandleKind::lever))), hub + 0.12 * 0.0264 * 0.018, 1e-9);
}

TEST(PanelSurface, LeverPointsWhereItsAngleSays) {
  test::BoardFiles files;
  PanelMap map = files.read();
  for (const double angle_deg : {0.0, 30.0, 90.0}) {
    map.turnHandle("C3", radians(angle_deg));
    const Handle& lever = map.handles[0];
    Surface placed;
    placed.add(surfaceOf(lever), lever.T_panel_handle());
    Vector3d farthest = lever.position_panel;
    for (const auto& v : placed.vertices) {
      const Vector3d p = v.position.cast<double>();
      if ((p - lever.position_panel).head<2>().norm() > (farthest - lever.position_panel).head<2>().norm())
        farthest = p;
    }
    const Vector3d arm = farthest - lever.position_panel;
    // The farthest point is a corner of the arm's end: half its width beside its middle.
    const double off_deg = degrees(std::atan2(0.11 * lever.length_m, 0.9 * lever.length_m));
    EXPECT_NEAR(std::abs(degrees(std::atan2(arm.y(), arm.x())) - angle_deg), off_deg, 1e-3) << angle_deg;
  }
}

TEST(PanelSurface, BodyIsClosed) {
  const PanelMap map = test::BoardFiles{}.read();
  expectClosed(map.body);
  expectNormalsOutwards(map.body);
  EXPECT_NEAR(volume_m3(map.body), 1.0 * 0.6 * 0.04, 1e-7);
}

TEST(PanelSurface, ShippedBodyIsClosed) {
  const PanelMap map = readPanelMap(std::filesystem::path(FATHOM_SOURCE_DIR) / "maps/dexrov/panel.yaml");
  expectClosed(map.body);
  expectNormalsOutwards(map.body);
}

/// The albedo of the marker's sheet at a point of it, by looking at every triangle.
float albedoAt(const Surface& sheet, double x, double y) {
  float found = -1.0f;
  for (const auto& t : sheet.triangles) {
    const Vector3d p(x, y, corner(sheet, t, 0).z());
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d edge = corner(sheet, t, (i + 1) % 3) - corner(sheet, t, i);
      inside = inside && edge.cross(p - corner(sheet, t, i)).z() > 0;
    }
    if (inside) found = sheet.vertices[t[0]].albedo.x();
  }
  return found;
}

TEST(PanelSurface, MarkersAreDrawnCellByCell) {
  test::BoardFiles files;
  files.yaml = test::kBoardYaml.substr(0, test::kBoardYaml.find("handles:"));
  PanelMap map = files.read();
  map.white_albedo = 0.7;
  map.black_albedo = 0.1;
  map.body = {};
  const Surface sheets = surfaceOf(map);
  expectNormalsOutwards(sheets);
  for (const auto& v : sheets.vertices) EXPECT_EQ(v.normal, Vector3f::UnitZ());
  for (const Marker& marker : map.markers) {
    const MarkerPattern pattern = markerPattern(marker.family, marker.id);
    const double cell = marker.size_m / pattern.border_cells;
    for (int row = 0; row < pattern.cells; ++row)
      for (int column = 0; column < pattern.cells; ++column) {
        // Off the cell's middle, which lies on the diagonal where two triangles meet.
        const Vector3d centre =
            marker.T_panel_marker * Vector3d((column + 0.47 - pattern.cells / 2.0) * cell,
                                             (pattern.cells / 2.0 - row - 0.44) * cell, 0);
        EXPECT_EQ(albedoAt(sheets, centre.x(), centre.y()), pattern.whiteAt(row, column) ? 0.7f : 0.1f)
            << marker.family << " row " << row << " column " << column;
      }
  }
}

TEST(PanelSurface, AddPosesTheOther) {
  Surface one;
  one.vertices.push_back({Vector3f(1, 2, 3), Vector3f::UnitX(), Vector3f(0.1f, 0.2f, 0.3f)});
  one.triangles.push_back({0, 0, 0});
  Surface both = one;
  both.add(one, {rotationFromYawPitchRoll(radians(90), 0, 0), Vector3d(10, 0, 0)});
  ASSERT_EQ(both.vertices.size(), 2U);
  EXPECT_LT((both.vertices[1].position - Vector3f(8, 1, 3)).norm(), 1e-6f);
  EXPECT_LT((both.vertices[1].normal - Vector3f::UnitY()).norm(), 1e-6f);
  EXPECT_EQ(both.vertices[1].albedo, one.vertices[0].albedo);
  EXPECT_EQ(both.triangles[1], (std::array<std::uint32_t, 3>{1, 1, 1}));
}

}  // namespace
}  // namespace fathom
