// Several panels in one map: what is read, and what is refused with which words.
#include "panel/panel_maps.h"

#include <gmock/gmock.h>

#include "simulation/copy_panel_map.h"
#include "support/panels.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::BoardFiles;
using test::kBoardYaml;
using test::with;
using testing::HasSubstr;

/// A folder with the tests' board, a second one beside it, and a list of both.
struct Boards {
  fs::path folder = test::scratchFolder();
  std::string second = with(with(with(kBoardYaml, "panel: board", "panel: other"), "id: 7", "id: 8"),
                            "tag36h11, id: 3", "tag36h11, id: 4");
  std::string list = "panels: [board.yaml, deep/other.yaml]\n";

  fs::path write() const {
    fs::create_directories(folder / "deep");
    BoardFiles{}.write(folder);
    test::writeNew(folder / "deep/other.yaml", with(second, "mesh: board.obj", "mesh: ../board.obj"));
    test::writeNew(folder / "list.yaml", list);
    return folder / "list.yaml";
  }
  std::string complaint() const {
    try {
      readPanelMaps(write());
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

TEST(PanelMaps, AreReadInTheirOrder) {
  const auto panels = readPanelMaps(Boards{}.write());
  ASSERT_EQ(panels.size(), 2U);
  EXPECT_EQ(panels[0].name, "board");
  EXPECT_EQ(panels[1].name, "other");
  EXPECT_EQ(panels[1].markers[0].id, 8);
}

TEST(PanelMaps, APanelsOwnMapIsOne) {
  const Boards boards;
  boards.write();
  const auto panels = readPanelMaps(boards.folder / "board.yaml");
  ASSERT_EQ(panels.size(), 1U);
  EXPECT_EQ(panels[0].name, "board");
  EXPECT_EQ(panelMapFiles(boards.folder / "board.yaml"), std::vector<fs::path>{boards.folder / "board.yaml"});
}

TEST(PanelMaps, AreStrict) {
  Boards boards;
  boards.list = "panels: [board.yaml]\npanel: board\n";
  EXPECT_THAT(boards.complaint(), HasSubstr("list.yaml: panel (line 2): unknown key"));
  boards.list = "panels: []\n";
  EXPECT_THAT(boards.complaint(), HasSubstr("names no panel"));
  boards.list = "panels: board.yaml\n";
  EXPECT_THAT(boards.complaint(), HasSubstr("must be a list"));
  boards.list = "panels: [board.yaml, gone.yaml]\n";
  EXPECT_THAT(boards.complaint(), HasSubstr("gone.yaml"));
  boards.list = "panels: [/board.yaml]\n";
  EXPECT_THAT(boards.complaint(), HasSubstr("/board.yaml must be relative to this file"));
  boards.list = "panels: [list.yaml]\n";  // no lists of lists
  EXPECT_THAT(boards.complaint(), HasSubstr("missing key `panel`"));
}

TEST(PanelMaps, WhatIsOnTwoPanelsTellsThemNotApart) {
  Boards boards;
  const std::string second = boards.second;
  boards.second = with(second, "panel: other", "panel: board");
  EXPECT_THAT(boards.complaint(), HasSubstr("list.yaml: panels (line 1): two panels are called `board`"));
  boards.second = with(second, "id: 8", "id: 7");
  EXPECT_THAT(boards.complaint(), HasSubstr("panels board and other both have DICT_ARUCO_ORIGINAL 7"));
  // OpenCV's drawing of the same tag, half a turn apart.
  boards.second = with(second, "family: DICT_ARUCO_ORIGINAL, id: 8", "family: DICT_APRILTAG_36h11, id: 3");
  EXPECT_THAT(boards.complaint(), HasSubstr("DICT_APRILTAG_36h11 3 of panel other looks the same as "
                                            "tag36h11 3 of panel board"));
  boards.second = second;
  EXPECT_EQ(boards.complaint(), "");
}

TEST(PanelMaps, TravelTogether) {
  const fs::path map = fs::path(FATHOM_SOURCE_DIR) / "maps/two_panels/panels.yaml";
  const fs::path folder = test::scratchFolder() / "copy";
  EXPECT_EQ(copyOfPanelMap(map, folder), folder / "two_panels/panels.yaml");
  const auto original = readPanelMaps(map), copy = readPanelMaps(copyPanelMap(map, folder));
  ASSERT_EQ(original.size(), 2U);
  ASSERT_EQ(copy.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(formatPanelMap(copy[i]), formatPanelMap(original[i]));
  EXPECT_TRUE(fs::exists(folder / "dexrov/panel.mtl"));
}

TEST(PanelMaps, OneTravelsAsBefore) {
  const fs::path map = fs::path(FATHOM_SOURCE_DIR) / "maps/dexrov/panel.yaml";
  const fs::path folder = test::scratchFolder() / "copy";
  EXPECT_EQ(copyPanelMap(map, folder), folder / "panel.yaml");
  EXPECT_TRUE(fs::exists(folder / "panel.obj"));
}

}  // namespace
}  // namespace fathom
