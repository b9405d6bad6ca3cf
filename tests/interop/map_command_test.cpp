// `fathom map`, as people and MRPT's viewer meet it.
#include <gtest/gtest.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSetOfTriangles.h>
#include <mrpt/opengl/CText3D.h>

#include <algorithm>
#include <opencv2/aruco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "recording/mrpt_types.h"
#include "support/panels.h"
#include "support/run_program.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
namespace gl = mrpt::opengl;
using test::runFathom;
using test::scratchFolder;
using test::shellQuoted;

const std::string kMaps = std::string(FATHOM_SOURCE_DIR) + "/maps/dexrov/";

TEST(MapCommand, CheckSumsUp) {
  const auto result = runFathom("map check " + kMaps + "panel.yaml " + kMaps + "panel_tag36h11.yaml");
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* part : {"panel dexrov\n", "panel dexrov_tag36h11\n", "1.680 x 2.340", "board_yellow",
                           "DICT_ARUCO_ORIGINAL: 7 101", "tag36h11: 3 10", "A1      lever   25.0 deg"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
}

TEST(MapCommand, CheckRefusesInOneLine) {
  const auto folder = scratchFolder();
  test::BoardFiles files;
  files.yaml = test::with(test::kBoardYaml, "tag36h11, id: 3", "tag36h11, id: 600");
  const auto bad = files.write(folder);
  test::expectBadInput(runFathom("map check " + kMaps + "panel.yaml " + bad.string()),
                       "board.yaml: markers[1].id (line 7): tag36h11 has ids 0 to 586, not 600");
  test::expectBadInput(runFathom("map check /no/such.yaml"), "/no/such.yaml");
  test::expectBadInput(runFathom("map"), "fathom map --help");
}

TEST(MapCommand, ShowRefusesInOneLineAndLeavesNothing) {
  const auto folder = scratchFolder();
  const std::string show = "map show " + kMaps + "panel.yaml --out " + shellQuoted((folder / "out").string());
  test::expectBadInput(runFathom(show + " --set A1=91"), "handle A1 turns from 0 to 90 deg");
  test::expectBadInput(runFathom(show + " --set Z9=1"), "no such handle: `Z9`");
  test::expectBadInput(runFathom(show + " --set A1"), "ID=ANGLE_DEG");
  test::expectBadInput(runFathom(show + " --set A1=ten"), "number of degrees");
  test::expectBadInput(runFathom(show + " --camera 0,0,0"), "--camera");
  test::expectBadInput(runFathom(show + " --camera 1,2"), "--camera");
  EXPECT_FALSE(fs::exists(folder / "out"));
}

/// Names of all labels, at any depth.
void collect(const gl::CSetOfObjects& set, std::multiset<std::string>& labels, std::size_t& triangles) {
  for (const auto& object : set) {
    if (const auto text = std::dynamic_pointer_cast<gl::CText3D>(object)) labels.insert(text->getString());
    if (const auto mesh = std::dynamic_pointer_cast<gl::CSetOfTriangles>(object))
      triangles += mesh->getTrianglesCount();
    if (const auto inner = std::dynamic_pointer_cast<gl::CSetOfObjects>(object))
      collect(*inner, labels, triangles);
  }
}

TEST(MapCommand, SceneIsReadByMrpt) {
  const auto folder = scratchFolder();
  ASSERT_EQ(runFathom("map show " + kMaps + "panel.yaml --out " + shellQuoted(folder.string())).status, 0);
  gl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile((folder / "dexrov.3Dscene").string()));
  const auto odom = std::dynamic_pointer_cast<gl::CSetOfObjects>(scene.getByName("odom"));
  ASSERT_TRUE(odom);
  const auto panel = std::dynamic_pointer_cast<gl::CSetOfObjects>(odom->getByName("panel dexrov"));
  ASSERT_TRUE(panel);

  const PanelMap map = readPanelMap(kMaps + "panel.yaml");
  const Pose T_odom_panel = fromMrpt(mrpt::poses::CPose3D(panel->getPose()));
  EXPECT_LT((T_odom_panel.position - map.T_odom_panel.position).norm(), 1e-6);
  EXPECT_LT(angleBetween(T_odom_panel.rotation, map.T_odom_panel.rotation), 1e-6);
  std::multiset<std::string> labels;
  std::size_t triangles = 0;
  collect(*odom, labels, triangles);
  EXPECT_EQ(triangles, surfaceOf(map).triangles.size());
  EXPECT_EQ(labels.size(), map.markers.size() + map.handles.size() + 2);
  for (const char* name : {"odom", "panel", "7", "966", "A1", "C4"})
    EXPECT_EQ(labels.count(name), 1U) << name;

  // What the viewer looks at first.
  const Pose T_scene_panel = fromMrpt(mrpt::poses::CPose3D(odom->getPose())) * T_odom_panel;
  EXPECT_LT(T_scene_panel.position.norm(), 1e-6);
  EXPECT_LT((T_scene_panel.rotation.col(2) - Vector3d(1, 1, 0).normalized()).norm(), 1e-6);
}

TEST(MapCommand, PictureShowsEveryMarkerWhereItIs) {
  const auto folder = scratchFolder();
  ASSERT_EQ(runFathom("map show " + kMaps + "panel.yaml --out " + shellQuoted(folder.string())).status, 0);
  const cv::Mat picture = cv::imread((folder / "dexrov.png").string());
  ASSERT_EQ(picture.size(), cv::Size(1280, 960));
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  cv::aruco::detectMarkers(picture, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_ARUCO_ORIGINAL),
                           corners, ids, parameters);
  EXPECT_EQ(ids.size(), 12U);
  Vector3d sum_px = Vector3d::Zero();
  for (const Marker& marker : readPanelMap(kMaps + "panel.yaml").markers) {
    const auto found = std::find(ids.begin(), ids.end(), marker.id);
    ASSERT_NE(found, ids.end()) << marker.id;
    for (std::size_t i = 0; i < 4; ++i) {
      // From 2 m in front of the panel's centre. The screen's curve bends what cornerSubPix() sees of one
      // corner, but not one way for all.
      const Vector3d corner = marker.corners_panel()[i];
      const double scale = 1150 / (2.0 - corner.z());
      const cv::Point2f& seen = corners[static_cast<std::size_t>(found - ids.begin())][i];
      const Vector3d error_px(seen.x - 639.5 - scale * corner.x(), seen.y - 479.5 + scale * corner.y(), 0);
      EXPECT_LT(error_px.norm(), 0.7) << marker.id << " corner " << i;
      sum_px += error_px;
    }
  }
  EXPECT_LT((sum_px / 48).norm(), 0.1);
}

TEST(MapCommand, HandlesTurnBeforeTheyAreShownAndBytesRepeat) {
  const auto folder = scratchFolder();
  const std::string show = "map show " + kMaps + "panel.yaml --out ";
  ASSERT_EQ(runFathom(show + shellQuoted((folder / "a").string())).status, 0);
  ASSERT_EQ(runFathom(show + shellQuoted((folder / "b").string())).status, 0);
  ASSERT_EQ(runFathom(show + shellQuoted((folder / "c").string()) + " --set A1=90 --set C1=10").status, 0);
  const auto bytes = [&folder](const char* run, const char* file) {
    return readTextFile(folder / run / file);
  };
  EXPECT_EQ(bytes("a", "dexrov.png"), bytes("b", "dexrov.png"));
  EXPECT_EQ(bytes("a", "dexrov.3Dscene"), bytes("b", "dexrov.3Dscene"));
  EXPECT_NE(bytes("a", "dexrov.png"), bytes("c", "dexrov.png"));
  EXPECT_NE(bytes("a", "dexrov.3Dscene"), bytes("c", "dexrov.3Dscene"));
}

}  // namespace
}  // namespace fathom
