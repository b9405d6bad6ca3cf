// A dive before a panel whose markers are printed otherwise: from its map to the robot's place.
#include <gtest/gtest.h>

#include "core/files.h"
#include "recording/tum.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

/// The shipped panel, with this in its map.
fs::path panelWith(const fs::path& folder, const std::string& keys) {
  const fs::path maps = test::kSource / "maps/dexrov";
  for (const char* name : {"panel.obj", "panel.mtl"}) writeTextFile(folder / name, readTextFile(maps / name));
  writeTextFile(folder / "panel.yaml", keys + readTextFile(maps / "panel_tag36h11.yaml"));
  return folder / "panel.yaml";
}

class MarkerLooks : public testing::TestWithParam<std::string> {};

TEST_P(MarkerLooks, AreDrawnAndFoundAsTheMapSays) {
  const fs::path folder = test::scratchFolder();
  writeTextFile(folder / "station.yaml",
                "kind: station\npose: {x: 3.9, y: 0.05, z: -4.25, yaw_deg: 1}\nduration_s: 10\nsway:\n"
                "  - {axis: y, amplitude_m: 0.1, period_s: 7}\n  - {axis: yaw, amplitude_deg: 3, period_s: "
                "8}\n");
  const auto quoted = [&](const std::string& name) { return test::shellQuoted((folder / name).string()); };
  const auto simulated = test::runFathom("simulate --trajectory " + quoted("station.yaml") +
                                         " --vehicle config/rov.yaml --map " +
                                         test::shellQuoted(panelWith(folder, GetParam()).string()) +
                                         " --water config/water_clear.yaml --name r --out " + quoted("r"));
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const auto localized = test::runFathom("localize " + quoted("r/r.rawlog") +
                                         " --tasks TL5 --paper-only --start reference --out " + quoted("l"));
  ASSERT_EQ(localized.status, 0) << localized.err;
  // As of the plain print, 0.010 m: that markers correct the path at all is what is asked here. Dead
  // reckoning is off by a decimetre after ten seconds, and a pose of the wrong marker by metres.
  EXPECT_NE(localized.out.find("position error 0.0"), std::string::npos) << localized.out;
}

INSTANTIATE_TEST_SUITE_P(Prints, MarkerLooks,
                         testing::Values("marker_look: {border_cells: 2}\n",
                                         "marker_look: {white_on_black: true}\n"));

}  // namespace
}  // namespace fathom
