// The grid of conditions that marker families are compared under, and the panels printed with them.
#include <gtest/gtest.h>

#include "evaluation/family_swap.h"
#include "evaluation/fiducial_comparison.h"
#include "panel/face.h"
#include "panel/marker_family.h"
#include "support/panels.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

using test::kSource;

FiducialGrid readGrid(const std::string& text) {
  const fs::path file = test::scratchFolder() / "grid.yaml";
  test::writeNew(file, text);
  return readFiducialGrid(file);
}

std::string gridComplaint(const std::string& text) {
  try {
    readGrid(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(FiducialGrid, ShippedFileIsTheDefault) {
  const FiducialGrid shipped = readFiducialGrid(kSource / "config/compare_fiducials.yaml"), built_in;
  EXPECT_EQ(shipped.families, built_in.families);
  EXPECT_EQ(shipped.backends, built_in.backends);
  EXPECT_EQ(shipped.preprocessings, built_in.preprocessings);
  EXPECT_EQ(shipped.ranges_m, built_in.ranges_m);
  EXPECT_EQ(shipped.tilts_rad, built_in.tilts_rad);
  EXPECT_EQ(shipped.blurs_px, built_in.blurs_px);
  EXPECT_EQ(shipped.repeats, built_in.repeats);
  EXPECT_EQ(shipped.match_px, built_in.match_px);
  EXPECT_EQ(shipped.seed, built_in.seed);
  ASSERT_EQ(shipped.waters.size(), built_in.waters.size());
  for (std::size_t i = 0; i < shipped.waters.size(); ++i) {
    EXPECT_EQ(shipped.waters[i].name, built_in.waters[i].name);
    EXPECT_EQ(shipped.waters[i].water.attenuation_per_m, built_in.waters[i].water.attenuation_per_m);
    EXPECT_EQ(shipped.waters[i].water.veil, built_in.waters[i].water.veil);
    EXPECT_EQ(shipped.waters[i].ambient, built_in.waters[i].ambient);
  }
  EXPECT_GE(built_in.families.size(), 4U);
  EXPECT_GE(built_in.imageCount(), 10000U);
}

TEST(FiducialGrid, WatersAreTheShippedOnes) {
  int known = 0;
  for (const NamedWater& water : FiducialGrid{}.waters) {
    const fs::path file = kSource / ("config/water_" + water.name + ".yaml");
    if (!fs::exists(file)) continue;
    const Environment environment = readEnvironment(file);
    EXPECT_EQ(water.water.attenuation_per_m, environment.water.attenuation_per_m) << file;
    EXPECT_EQ(water.water.veil, environment.water.veil) << file;
    EXPECT_EQ(water.ambient, environment.ambient) << file;
    ++known;
  }
  EXPECT_EQ(known, 3);
}

TEST(FiducialGrid, LeftOutKeysKeepTheirDefaults) {
  const FiducialGrid grid = readGrid("ranges_m: [2, 5]\ntilts_deg: [30]\nrepeats: 3\n");
  EXPECT_EQ(grid.ranges_m, (std::vector<double>{2, 5}));
  EXPECT_DOUBLE_EQ(grid.tilts_rad.at(0), radians(30));
  EXPECT_EQ(grid.families, FiducialGrid{}.families);
  EXPECT_EQ(grid.viewCount(), 6U);
  EXPECT_EQ(grid.imageCount(), 6 * 5 * 4 * 3U);
}

TEST(FiducialGrid, TellsWhatIsWrong) {
  const auto expectComplaint = [](const std::string& text, const std::string& where, const std::string& why) {
    const std::string complaint = gridComplaint(text);
    EXPECT_NE(complaint.find(where), std::string::npos) << text << " -> " << complaint;
    EXPECT_NE(complaint.find(why), std::string::npos) << text << " -> " << complaint;
  };
  expectComplaint("families: []\n", "families", "at least one");
  expectComplaint("families: [tag36h12]\n", "families", "no such marker family: `tag36h12`");
  expectComplaint("families: [tag36h11, tag36h11]\n", "families", "twice");
  expectComplaint("families: [tagStandard41h12]\n", "families", "aruco backend cannot read tagStandard41h12");
  EXPECT_EQ(gridComplaint("families: [tagStandard41h12]\nbackends: [apriltag]\n"), "");
  expectComplaint("backends: [artoolkit]\n", "backends", "`artoolkit` is none of aruco, apriltag");
  expectComplaint("backends: []\n", "backends", "at least one");
  expectComplaint("preprocessings: [blur]\n", "preprocessings", "none of none, stretch, clahe");
  expectComplaint("ranges_m: [0]\n", "ranges_m", "between");
  expectComplaint("ranges_m: [2, 2]\n", "ranges_m", "twice");
  expectComplaint("tilts_deg: [90]\n", "tilts_deg", "between");
  expectComplaint("blurs_px: [-1]\n", "blurs_px", "between");
  expectComplaint("repeats: 0\n", "repeats", "between");
  expectComplaint("match_px: 0\n", "match_px", "greater than zero");
  expectComplaint("waters: []\n", "waters", "at least one");
  expectComplaint("ranges: [1]\n", "ranges", "ranges_m");
  expectComplaint("waters:\n  - {name: a, attenuation_per_m: [1, 1], veil: [0, 0, 0], ambient: [1, 1, 1]}\n",
                  "attenuation_per_m", "three numbers");
}

TEST(FiducialGrid, ViewsAreWhereTheGridSaysAndTheSameForAll) {
  const FiducialGrid grid;
  for (std::size_t range = 0; range < grid.ranges_m.size(); ++range)
    for (std::size_t tilt = 0; tilt < grid.tilts_rad.size(); ++tilt) {
      const GridImage first{0, range, tilt, 0, 0, 0}, other{3, range, tilt, 0, 2, 1},
          next{0, range, tilt, 1, 0, 0};
      const Pose T_panel_camera = viewOf(grid, first).T_panel_camera();
      EXPECT_NEAR(T_panel_camera.position.norm(), grid.ranges_m[range], 1e-12);
      const double cosine = T_panel_camera.position.normalized().z();
      EXPECT_NEAR(std::acos(std::min(1.0, cosine)), grid.tilts_rad[tilt], 1e-7);
      EXPECT_EQ(viewOf(grid, other).T_panel_camera().position, T_panel_camera.position);
      EXPECT_GT(angleBetween(viewOf(grid, next).T_panel_camera().rotation, T_panel_camera.rotation), 1e-3);
    }
}

TEST(FamilySwap, KeepsPlacesAndSizes) {
  const PanelMap map = readPanelMap(kSource / "maps/dexrov/panel.yaml");
  std::vector<std::string> families = FiducialGrid{}.families;
  families.insert(families.end(), {"DICT_7X7_1000", "DICT_APRILTAG_36h11", "tag25h9"});
  for (const auto& family : families) {
    const PanelMap swapped = withFamily(map, family);
    ASSERT_EQ(swapped.markers.size(), map.markers.size());
    for (std::size_t i = 0; i < map.markers.size(); ++i) {
      const Marker& marker = swapped.markers[i];
      EXPECT_EQ(marker.family, family);
      EXPECT_LT(marker.id, markerCount(family));
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_EQ(marker.corners_panel()[k], map.markers[i].corners_panel()[k]) << family << " " << i;
      for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(lookAlike(marker, swapped.markers[j])) << family;
    }
  }
}

TEST(FamilySwap, KeepsThePanelsOwnMarkers) {
  const PanelMap map = readPanelMap(kSource / "maps/dexrov/panel.yaml");
  const PanelMap same = withFamily(map, "DICT_ARUCO_ORIGINAL");
  for (std::size_t i = 0; i < map.markers.size(); ++i) EXPECT_EQ(same.markers[i].id, map.markers[i].id);
}

TEST(FamilySwap, RefusesWhatDoesNotFit) {
  PanelMap map = test::BoardFiles{}.read();
  const Marker first = map.markers[0];
  for (int i = 0; i < 30; ++i) map.markers.push_back(first);
  EXPECT_THROW(withFamily(map, "tag16h5"), Error);  // 30 ids for 32 markers
  // tagStandard41h12's data ring is 9 / 5 of its border square: over the edge of a board that ends beside it.
  map.markers.assign(1, first);
  map.markers[0].size_m = 0.3;
  map.markers[0].T_panel_marker.position = {-0.3, 0.1, 0.001};
  EXPECT_NO_THROW(withFamily(map, "DICT_4X4_50"));
  EXPECT_THROW(withFamily(map, "tagStandard41h12"), Error);
}

}  // namespace
}  // namespace fathom
