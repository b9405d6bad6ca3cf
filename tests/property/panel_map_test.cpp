// Laws of the panel map that hold for any panel.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "core/random.h"
#include "panel/marker_family.h"
#include "support/panels.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

/// Printable, UTF-8 among it; never empty.
std::string anyText(Random& random) {
  static const std::vector<std::string> letters{"a",  "Z", "3", " ", "#", ":", "-",  "'", "\"",
                                                "\\", "{", "}", "[", "]", ",", "&",  "*", "!",
                                                "%",  "@", "`", "|", ">", "é", "漢", "~"};
  std::string text;
  const auto length = 1 + random.bits() % 8;
  for (std::size_t i = 0; i < length; ++i) text += letters[random.bits() % letters.size()];
  return text;
}

Matrix3d anyRotation(Random& random) {
  return rotationFromYawPitchRoll(random.uniform(-3, 3), random.uniform(-1.5, 1.5), random.uniform(-3, 3));
}

/// Markers in places of a grid that do not touch, on the front of the board of test::kBoardObj.
PanelMap anyMap(Random& random) {
  PanelMap map;
  map.name = anyText(random);
  map.mesh_file = "board.obj";
  map.T_odom_panel = {anyRotation(random), 10 * random.normal3()};
  map.position_sigma_m = random.uniform();
  map.angle_sigma_rad = random.uniform();
  map.white_albedo = random.uniform(0.5, 1.0);
  map.black_albedo = random.uniform(0.0, 0.5);
  const auto& families = markerFamilies();
  for (int place = 0; place < 8; ++place) {
    if (random.uniform() < 0.3) continue;
    Marker m;
    m.family = families[random.bits() % families.size()];
    // Ids apart: the dictionaries of one size begin with the same markers.
    m.id = static_cast<int>(random.bits() % 3) + 3 * place;
    m.size_m = random.uniform(0.01, 0.06);
    m.T_panel_marker = {
        rotationFromYawPitchRoll(random.uniform(-3.1, 3.1), 0, 0),
        Vector3d(-0.3 + 0.2 * (place % 4), place < 4 ? -0.1 : 0.1, random.uniform(0.0, 0.009))};
    map.markers.push_back(m);
  }
  const auto handles = random.bits() % 4;
  for (std::size_t i = 0; i < handles; ++i) {
    Handle h;
    h.id = anyText(random) + std::to_string(i);
    h.kind = std::array{HandleKind::lever, HandleKind::valve, HandleKind::wheel}[random.bits() % 3];
    h.position_panel = random.normal3();
    h.radius_m = random.uniform(1e-3, 1);
    h.length_m = random.uniform(1e-3, 1);
    h.smallest_angle_rad = random.uniform(-7, 7);
    h.largest_angle_rad = h.smallest_angle_rad + random.uniform(0, 7);
    h.angle_rad = random.uniform(h.smallest_angle_rad, h.largest_angle_rad);
    map.handles.push_back(h);
  }
  return map;
}

bool sameMarker(const Marker& a, const Marker& b) {
  return a.family == b.family && a.id == b.id && a.size_m == b.size_m &&
         a.T_panel_marker.position == b.T_panel_marker.position &&
         angleBetween(a.T_panel_marker.rotation, b.T_panel_marker.rotation) < 1e-12;
}

bool sameHandle(const Handle& a, const Handle& b) {
  return a.id == b.id && a.kind == b.kind && a.position_panel == b.position_panel &&
         a.radius_m == b.radius_m && a.length_m == b.length_m &&
         std::abs(a.smallest_angle_rad - b.smallest_angle_rad) < 1e-12 &&
         std::abs(a.largest_angle_rad - b.largest_angle_rad) < 1e-12 &&
         std::abs(a.angle_rad - b.angle_rad) < 1e-12;
}

TEST(PanelMapProperty, AnyMapSurvivesItsText) {
  const auto folder = test::scratchFolder();
  const bool holds = rc::check([&folder](std::uint64_t seed) {
    Random random(seed);
    const PanelMap map = anyMap(random);
    test::BoardFiles files;
    files.yaml = formatPanelMap(map);
    PanelMap back;
    try {
      back = readPanelMap(files.write(folder));
    } catch (const Error& error) {
      // Some families have markers in common with others: a map refuses both.
      if (error.why.find("looks the same") != std::string::npos) RC_DISCARD("markers alike");
      throw;
    }
    RC_ASSERT(back.name == map.name);
    RC_ASSERT(back.mesh_file == map.mesh_file);
    RC_ASSERT(back.T_odom_panel.position == map.T_odom_panel.position);
    RC_ASSERT(angleBetween(back.T_odom_panel.rotation, map.T_odom_panel.rotation) < 1e-11);
    RC_ASSERT(back.position_sigma_m == map.position_sigma_m);
    RC_ASSERT(std::abs(back.angle_sigma_rad - map.angle_sigma_rad) < 1e-12);
    RC_ASSERT(back.white_albedo == map.white_albedo && back.black_albedo == map.black_albedo);
    RC_ASSERT(std::equal(map.markers.begin(), map.markers.end(), back.markers.begin(), back.markers.end(),
                         sameMarker));
    RC_ASSERT(std::equal(map.handles.begin(), map.handles.end(), back.handles.begin(), back.handles.end(),
                         sameHandle));
    RC_ASSERT(formatPanelMap(back) == files.yaml);
  });
  EXPECT_TRUE(holds);
}

TEST(PanelMapProperty, TurningAHandleMovesNothingElse) {
  const PanelMap board = test::BoardFiles{}.read();
  const bool holds = rc::check([&board](std::uint64_t seed) {
    Random random(seed);
    PanelMap turned = board;
    turned.turnHandle(
        "A1", random.uniform(board.handles[1].smallest_angle_rad, board.handles[1].largest_angle_rad));
    const Surface before = surfaceOf(board), after = surfaceOf(turned);
    RC_ASSERT(before.vertices.size() == after.vertices.size());
    const std::size_t wheel = surfaceOf(board.handles[1]).vertices.size();  // the last to be drawn
    for (std::size_t i = 0; i < before.vertices.size() - wheel; ++i)
      RC_ASSERT(before.vertices[i].position == after.vertices[i].position);
    for (std::size_t i = before.vertices.size() - wheel; i < before.vertices.size(); ++i) {
      const Vector3d axis = board.handles[1].position_panel;
      const Vector3d a = before.vertices[i].position.cast<double>() - axis;
      const Vector3d b = after.vertices[i].position.cast<double>() - axis;
      RC_ASSERT(std::abs(a.head<2>().norm() - b.head<2>().norm()) < 1e-6 && a.z() == b.z());
    }
  });
  EXPECT_TRUE(holds);
}

}  // namespace
}  // namespace fathom
