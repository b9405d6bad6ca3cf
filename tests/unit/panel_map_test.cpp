// The panel map: what is read, and what is refused with which words.
#include <gmock/gmock.h>

#include "panel/panel_maps.h"
#include "support/panels.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::BoardFiles;
using test::kBoardMtl;
using test::kBoardObj;
using test::kBoardYaml;
using test::with;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(PanelMap, IsReadAsWritten) {
  const PanelMap map = BoardFiles{}.read();
  EXPECT_EQ(map.name, "board");
  EXPECT_EQ(map.mesh_file, "board.obj");
  EXPECT_EQ(map.T_odom_panel.position, Vector3d(6, 0.5, -4));
  EXPECT_EQ(map.position_sigma_m, 0.1);
  EXPECT_DOUBLE_EQ(map.angle_sigma_rad, radians(2));
  EXPECT_EQ(map.white_albedo, 0.85);
  EXPECT_EQ(map.black_albedo, 0.04);
  EXPECT_EQ(map.materials, (std::vector<std::string>{"grey", "yellow"}));
  EXPECT_EQ(map.components, 1);
  EXPECT_EQ(map.body.triangles.size(), 12U);
  ASSERT_EQ(map.markers.size(), 2U);
  EXPECT_EQ(map.markers[0].family, "DICT_ARUCO_ORIGINAL");
  EXPECT_EQ(map.markers[0].id, 7);
  EXPECT_EQ(map.markers[0].size_m, 0.16);
  ASSERT_EQ(map.handles.size(), 2U);
  EXPECT_EQ(map.handles[0].id, "C3");
  EXPECT_EQ(map.handles[0].kind, HandleKind::lever);
  EXPECT_EQ(map.handles[1].kind, HandleKind::wheel);
  EXPECT_EQ(map.handles[1].position_panel, Vector3d(0, -0.1, 0));
  EXPECT_DOUBLE_EQ(map.handles[1].smallest_angle_rad, radians(-180));
  EXPECT_DOUBLE_EQ(map.handles[1].angle_rad, radians(-45));
}

// A panel's twist is told by the height of its face's corners. The shipped panel stands on legs that
// reach 1.8 m below its middle: taken for the panel, what is 2 mm at the face's corner is 7 mm.
TEST(PanelMap, IsAsLargeAsItsFace) {
  const PanelMap map = readPanelMap(fs::path(FATHOM_SOURCE_DIR) / "maps/dexrov/panel.yaml");
  EXPECT_NEAR(map.half_extent_m.x(), 0.8, 1e-6);
  EXPECT_NEAR(map.half_extent_m.y(), 0.5, 1e-6);
  EXPECT_EQ(map.markers.front().panel_half_m, map.half_extent_m);
}

TEST(PanelMap, HasTheLookOfItsMarkers) {
  BoardFiles files;
  EXPECT_EQ(files.read().look(), MarkerLook{});
  files.yaml = "marker_look: {border_cells: 2, white_on_black: true, saddle_corners: true}\n" + files.yaml;
  const PanelMap map = files.read();
  EXPECT_EQ(map.look(), (MarkerLook{2, true, true}));
  EXPECT_EQ(map.markers.at(1).look, map.look());
  files.yaml = formatPanelMap(map);
  EXPECT_EQ(files.read().look(), map.look());
}

TEST(PanelMap, StandsUprightAndFacesTheRobot) {
  // The contract's example: the face looks towards -x of odom, y of the panel is up, x is to the right of who
  // looks.
  const Matrix3d R = BoardFiles{}.read().T_odom_panel.rotation;
  EXPECT_LT((R.col(2) - Vector3d(-1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((R.col(1) - Vector3d(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT((R.col(0) - Vector3d(0, -1, 0)).norm(), 1e-15);
}

TEST(PanelMap, CornersByHand) {
  const PanelMap map = BoardFiles{}.read();
  const auto expect = [](const std::array<Vector3d, 4>& corners, const std::array<Vector3d, 4>& by_hand) {
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((corners[i] - by_hand[i]).norm(), 1e-15) << i;
  };
  const double z = 0.001;
  expect(map.markers[0].corners_panel(), {Vector3d(-0.38, 0.18, z), Vector3d(-0.22, 0.18, z),
                                          Vector3d(-0.22, 0.02, z), Vector3d(-0.38, 0.02, z)});
  // A quarter turn counter-clockwise: the upright top left is at the bottom left.
  expect(map.markers[1].corners_panel(), {Vector3d(0.22, -0.18, z), Vector3d(0.22, -0.02, z),
                                          Vector3d(0.38, -0.02, z), Vector3d(0.38, -0.18, z)});
}

TEST(PanelMap, MaterialsAreLinearAlbedoToTheLastDigit) {
  for (const auto& v : BoardFiles{}.read().body.vertices) {
    const bool left = v.normal.x() < -0.5f;
    EXPECT_EQ(v.albedo, left ? Eigen::Vector3f(0.2f, 0.2f, 0.25f) : Eigen::Vector3f(0.6f, 0.5f, 0.1f));
  }
}

TEST(PanelMap, MarkersHandlesAndAlbedosMayBeAbsent) {
  BoardFiles files;
  files.yaml = kBoardYaml.substr(0, kBoardYaml.find("markers:")) + "white_albedo: 0.7\nblack_albedo: 0.1\n";
  const PanelMap map = files.read();
  EXPECT_TRUE(map.markers.empty());
  EXPECT_TRUE(map.handles.empty());
  EXPECT_EQ(map.white_albedo, 0.7);
  EXPECT_EQ(map.black_albedo, 0.1);
}

struct Bad {
  const char* name;
  std::string from, to;  ///< in the YAML
  std::string where, why;
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }
class BadYaml : public testing::TestWithParam<Bad> {};

TEST_P(BadYaml, IsOneLineWithFileAndKey) {
  BoardFiles files;
  files.yaml = with(kBoardYaml, GetParam().from, GetParam().to);
  const std::string complaint = files.complaint();
  EXPECT_THAT(complaint, AllOf(HasSubstr("board.yaml: " + GetParam().where), HasSubstr(GetParam().why),
                               Not(HasSubstr("\n"))));
}

const Bad kBadYamls[] = {
    {"MissingName", "panel: board\n", "", "", "missing key `panel`"},
    {"MissingPose", "pose: {x", "other: {x", "", "missing key `pose`"},
    {"MissingSigma", "angle_deg: 2", "", "pose_sigma", "missing key `angle_deg`"},
    {"NegativeSigma", "angle_deg: 2", "angle_deg: -2", "pose_sigma.angle_deg (line 3)", "negative"},
    {"MissingMeshKey", "mesh: board.obj\n", "", "", "missing key `mesh`"},
    {"MissingMesh", "mesh: board.obj", "mesh: none.obj", "mesh (line 4)", "there is no file"},
    {"MeshNameTooLong", "mesh: board.obj", "mesh: " + std::string(300, 'a'), "mesh (line 4)",
     "there is no file"},
    {"MeshIsFolder", "mesh: board.obj", "mesh: .", "mesh (line 4)", "there is no file"},
    {"UnknownKey", "rotation_deg: 0}", "rotation_deg: 0, colour: red}", "markers[0].colour (line 6)",
     "unknown key"},
    {"Misspelt", "panel: board", "panel: board\npose_sigmas: 0", "pose_sigmas (line 2)", "unknown key"},
    {"NoUnit", "size_m: 0.16", "size: 0.16", "markers[0].size (line 6)", "did you mean `size_m`"},
    {"MarkersNoList", "markers:\n", "markers: {}\nextra:\n", "markers (line 5)", "list"},
    {"ThickBorder", "mesh: b", "marker_look: {border_cells: 3}\nmesh: b", "marker_look.border_cells (line 4)",
     "1 or 2"},
    {"NoPlainBorder", "mesh: board.obj\nmarkers:\n  - {family: DICT_ARUCO_ORIGINAL",
     "mesh: board.obj\nmarker_look: {border_cells: 2}\nmarkers:\n  - {family: tagStandard41h12",
     "markers[0].family (line 7)", "no plain border"},
    {"UnknownFamily", "tag36h11", "tag36h12", "markers[1].family (line 7)", "`tag36h12`"},
    {"IdTooLarge", "tag36h11, id: 3", "tag36h11, id: 587", "markers[1].id (line 7)", "0 to 586"},
    {"IdNegative", "tag36h11, id: 3", "tag36h11, id: -1", "markers[1].id (line 7)", "-1"},
    {"IdNoInteger", "tag36h11, id: 3", "tag36h11, id: 3.5", "markers[1].id (line 7)", "whole"},
    {"ZeroSize", "size_m: 0.16", "size_m: 0", "markers[0].size_m (line 6)", "greater than zero"},
    {"NegativeSize", "size_m: 0.16", "size_m: -0.16", "markers[0].size_m (line 6)", "greater than zero"},
    {"BesideFace", "x: -0.3, y: 0.1", "x: -0.43, y: 0.1", "markers[0] (line 6)", "does not lie on the face"},
    {"PatternBesideFace", "x: 0.3, y: -0.1", "x: 0.41, y: -0.1", "markers[1] (line 7)", "corner at x 0.51"},
    {"InFrontOfFace", "y: 0.1, z: 0.001, r", "y: 0.1, z: 0.02, r", "markers[0] (line 6)", "within 1 cm"},
    {"BehindFace", "y: 0.1, z: 0.001, r", "y: 0.1, z: -0.001, r", "markers[0].z (line 6)", "behind the face"},
    {"OnTheBack", "y: 0.1, z: 0.001, r", "y: 0.1, z: -0.041, r", "markers[0] (line 6)",
     "does not lie on the face"},
    {"Twice", "family: tag36h11, id: 3", "family: DICT_ARUCO_ORIGINAL, id: 7", "markers[1].id (line 7)",
     "twice"},
    {"Overlap", "x: 0.3, y: -0.1", "x: -0.14, y: 0.1", "markers[1] (line 7)",
     "overlaps DICT_ARUCO_ORIGINAL 7"},
    {"HandleTwice", "id: A1", "id: C3", "handles[1].id (line 10)", "two handles `C3`"},
    {"UnknownKind", "kind: lever", "kind: knob", "handles[0].kind (line 9)", "`knob`"},
    {"RangeReversed", "[0, 90]", "[90, 0]", "handles[0].range_deg (line 9)", "reversed"},
    {"RangeOfThree", "[0, 90]", "[0, 45, 90]", "handles[0].range_deg (line 9)", "[smallest, largest]"},
    {"AngleOutside", "angle_deg: 30", "angle_deg: 91", "handles[0].angle_deg (line 9)", "0 to 90 deg"},
    {"AngleMissing", "angle_deg: 30", "", "handles[0] (line 9)", "missing key `angle_deg`"},
    {"RadiusZero", "radius_m: 0.06", "radius_m: 0", "handles[0].radius_m (line 9)", "greater than zero"},
    {"WhiteAboveOne", "mesh:", "white_albedo: 1.1\nmesh:", "white_albedo (line 4)", "at most 1"},
    {"BlackNegative", "mesh:", "black_albedo: -0.1\nmesh:", "black_albedo (line 4)", "negative"},
    {"BlackAsWhite", "mesh:", "black_albedo: 0.85\nmesh:", "black_albedo (line 4)", "darker"},
};
INSTANTIATE_TEST_SUITE_P(PanelMap, BadYaml, testing::ValuesIn(kBadYamls),
                         [](const auto& bad) { return std::string(bad.param.name); });

TEST(PanelMap, MarkersThatLookAlikeAreRefused) {
  // The first 50 of OpenCV's dictionaries of a size are the same; AprilTag's tags are in OpenCV half a turn
  // round.
  for (const auto& [first, second] :
       {std::pair("family: DICT_5X5_50, id: 8", "family: DICT_5X5_1000, id: 8"),
        std::pair("family: DICT_APRILTAG_25h9, id: 4", "family: tag25h9, id: 4")}) {
    BoardFiles files;
    files.yaml = with(with(kBoardYaml, "family: DICT_ARUCO_ORIGINAL, id: 7", first),
                      "family: tag36h11, id: 3", second);
    EXPECT_THAT(files.complaint(), HasSubstr("markers[1].id (line 7): ")) << second;
    EXPECT_THAT(files.complaint(), HasSubstr("looks the same as")) << second;
  }
}

TEST(PanelMap, TurnedMarkersMayComeNearEachOther) {
  // Two squares, the second a diamond, whose bounding boxes overlap, but not they.
  BoardFiles files;
  files.yaml =
      with(with(kBoardYaml, "id: 7, size_m: 0.16, x: -0.3, y: 0.1", "id: 7, size_m: 0.1, x: 0.18, y: 0.0"),
           "rotation_deg: 90", "rotation_deg: 45");
  files.yaml = with(files.yaml, "x: 0.3, y: -0.1", "x: 0.3, y: -0.14");
  EXPECT_EQ(files.complaint(), "");
  files.yaml = with(files.yaml, "x: 0.18, y: 0.0", "x: 0.22, y: -0.04");
  EXPECT_THAT(files.complaint(), HasSubstr("overlaps"));
}

TEST(PanelMap, MarkerOnTheVeryFaceIsDrawnBeforeIt) {
  BoardFiles files;
  files.yaml = with(kBoardYaml, "y: 0.1, z: 0.001", "y: 0.1, z: 0");
  const PanelMap map = files.read();
  EXPECT_EQ(map.markers[0].corners_panel()[0].z(), 0.0);
  const Surface all = surfaceOf(map);
  const auto& ink = all.vertices[map.body.vertices.size()];  // the first marker follows the body
  EXPECT_GT(ink.position.z(), 1e-4f);
  EXPECT_LT(ink.position.z(), 1e-3f);
}

// ---- handles

TEST(PanelMap, HandlesTurnWithinTheirRange) {
  PanelMap map = BoardFiles{}.read();
  map.turnHandle("C3", radians(90));
  EXPECT_EQ(map.handles[0].angle_rad, radians(90));
  EXPECT_THROW(map.turnHandle("C3", radians(91)), std::invalid_argument);
  EXPECT_THROW(map.turnHandle("C3", std::nan("")), std::invalid_argument);
  EXPECT_THROW(map.turnHandle("C4", 0), std::invalid_argument);
  EXPECT_EQ(map.handles[0].angle_rad, radians(90));
}

TEST(PanelMap, MeshMayHoldHandlesByName) {
  // A knob over C3 in the mesh shows one state; the map draws the present one.
  const std::string knob =
      "o NAME\nusemtl grey\nv 0 0.1 0\nv 0.02 0.1 0\nv 0 0.12 0\nv 0 0.1 0.02\n"
      "f 9 11 10\nf 9 10 12\nf 10 11 12\nf 11 9 12\n";
  BoardFiles files;
  files.obj = kBoardObj + with(knob, "NAME", "handle_C3");
  EXPECT_EQ(files.read().body.triangles.size(), 12U);
  EXPECT_EQ(files.read().components, 1);
  files.obj = kBoardObj + with(knob, "NAME", "handle_B9");
  EXPECT_EQ(files.read().body.triangles.size(), 16U);
  EXPECT_EQ(files.read().components, 2);
}

// ---- the mesh

struct BadMesh {
  const char* name;
  std::string from, to;  ///< in the OBJ
  std::string where, why;
};
void PrintTo(const BadMesh& bad, std::ostream* out) { *out << bad.name; }
class BadObj : public testing::TestWithParam<BadMesh> {};

TEST_P(BadObj, IsOneLineWithFileAndLine) {
  BoardFiles files;
  files.obj = with(kBoardObj, GetParam().from, GetParam().to);
  const std::string complaint = files.complaint();
  EXPECT_THAT(complaint, AllOf(HasSubstr("board.obj: " + GetParam().where), HasSubstr(GetParam().why),
                               Not(HasSubstr("\n"))));
}

// Made when asked for: at start-up kBoardObj may not be there yet.
std::vector<BadMesh> badObjs() {
  return {
      {"Empty", kBoardObj, "", "", "no faces"},
      {"NoFaces", kBoardObj.substr(kBoardObj.find("f 5")), "", "", "no faces"},
      {"NoNumber", "v 0.5 0.3 0\n", "v 0.5 0.3 zero\n", "line 11", "three numbers"},
      {"NotFinite", "v 0.5 0.3 0\n", "v 0.5 0.3 nan\n", "line 11", "three numbers"},
      {"NoVertex", "f 5 6 8 7\n", "f 5 6 9 7\n", "line 12", "vertex 9"},
      {"VertexZero", "f 5 6 8 7\n", "f 0 6 8 7\n", "line 12", "`0`"},
      {"VertexTwice", "f 5 6 8 7\n", "f 5 6 6 7\n", "line 12", "twice"},
      {"TwoCorners", "f 5 6 8 7\n", "f 5 6\n", "line 12", "three vertices"},
      {"Flipped", "f 1 2 6\n", "f 1 6 2\n", "line 14", "turned against its neighbour in line 13"},
      {"InsideOut", "f 5 6 8 7\nf 2 1 3 4\nf 1 2 6\nf 1 6 5\nf 4 3 7 8\nf 2 4 8 6\nusemtl grey\nf 3 1 5 7\n",
       "f 7 8 6 5\nf 4 3 1 2\nf 6 2 1\nf 5 6 1\nf 8 7 3 4\nf 6 8 4 2\nf 7 5 1 3\n", "line 12", "inside out"},
      {"ThreeOnAnEdge", "usemtl grey\n", "v 0 0 1\nf 5 6 9\n", "", "shared by 3 faces"},
      {"VertexShared", "usemtl grey\n", "v 0.6 0.4 0\nv 0.7 0.4 0\nf 8 9 10\n", "", "not manifold"},
      {"NoArea", "usemtl grey\n", "v 0.9 0 0\nv 0.8 0 0\nv 0.7 0 0\nf 9 10 11\n", "line 21", "no area"},
      {"NotPlane", "v 0.5 0.3 0\n", "v 0.5 0.3 0.1\n", "line 12", "plane and convex"},
      {"Millimetres", "v -0.5 -0.3 -0.04\n", "v -500 -300 -40\n", "", "is its unit the metre?"},
      {"NoMaterial", "usemtl yellow\n", "\n", "line 12", "without a material"},
      {"UnknownMaterial", "usemtl yellow", "usemtl blue", "line 3", "`blue`"},
      {"MissingLibrary", "mtllib board.mtl", "mtllib none.mtl", "line 1", "none.mtl is missing"},
  };
}
INSTANTIATE_TEST_SUITE_P(PanelMap, BadObj, testing::ValuesIn(badObjs()),
                         [](const auto& bad) { return std::string(bad.param.name); });

TEST(PanelMap, SmallAndLargeMeshesAreSuspected) {
  for (const char* to : {"v -0.001 -0.001 -0.001\n", ""}) {
    BoardFiles files;
    files.yaml = kBoardYaml.substr(0, kBoardYaml.find("markers:"));
    files.obj = kBoardObj;
    const std::string unit = *to != '\0' ? "0.00" : "30.";  // 1.0 x 0.6 m becomes 1 cm at most, or 60 m
    for (std::size_t at = 0; (at = files.obj.find("0.", at)) != std::string::npos; at += unit.size())
      files.obj.replace(at, 2, unit);
    EXPECT_THAT(files.complaint(), HasSubstr("is its unit the metre?")) << unit;
  }
}

TEST(PanelMap, BadMaterialsAreOneLine) {
  const std::tuple<std::string, std::string, std::string> bad[] = {
      {"Kd 0.6 0.5 0.1\n", "", "board.mtl: line 1: material `yellow` has no Kd"},
      {"Kd 0.6 0.5 0.1", "Kd 0.6 0.5", "board.mtl: line 2: `Kd` needs three numbers"},
      {"Kd 0.6 0.5 0.1", "Kd 153 128 26", "board.mtl: line 2: Kd is the linear albedo, from 0 to 1"},
      {"newmtl grey", "newmtl yellow", "board.mtl: line 4: material `yellow` is defined twice"},
      {"newmtl yellow\n", "", "board.mtl: line 1: `Kd` without a material"},
  };
  for (const auto& [from, to, words] : bad) {
    BoardFiles files;
    files.mtl = with(kBoardMtl, from, to);
    EXPECT_THAT(files.complaint(), HasSubstr(words));
  }
}

TEST(PanelMap, MeshIndicesMayCountBackAndCarryMore) {
  BoardFiles files;
  files.obj = with(with(kBoardObj, "f 5 6 8 7\n", "f -4 -3 -1 -2\n"), "f 2 1 3 4\n",
                   "vn 0 0 -1\nf 2//1 1//1 3//1 4//1\n");
  EXPECT_EQ(files.read().body.triangles.size(), 12U);
}

// ---- there and back

void expectSame(const PanelMap& a, const PanelMap& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.mesh_file, b.mesh_file);
  EXPECT_EQ(a.T_odom_panel.position, b.T_odom_panel.position);
  EXPECT_LT(angleBetween(a.T_odom_panel.rotation, b.T_odom_panel.rotation), 1e-12);
  EXPECT_EQ(a.markers.size(), b.markers.size());
  ASSERT_EQ(a.handles.size(), b.handles.size());
  for (std::size_t i = 0; i < a.handles.size(); ++i) {
    EXPECT_EQ(a.handles[i].id, b.handles[i].id);
    EXPECT_NEAR(a.handles[i].angle_rad, b.handles[i].angle_rad, 1e-12);
  }
}

TEST(PanelMap, FormattedMapReadsBackWithTheNewState) {
  PanelMap map = BoardFiles{}.read();
  map.turnHandle("C3", radians(71.25));
  BoardFiles files;
  files.yaml = formatPanelMap(map);
  EXPECT_THAT(files.yaml, HasSubstr("angle_deg: 71.25}"));
  expectSame(map, files.read());
  EXPECT_EQ(formatPanelMap(files.read()), files.yaml);
}

// ---- maps that are there

TEST(PanelMap, EveryShippedMapIsReadAndFits) {
  int maps = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(FATHOM_SOURCE_DIR) / "maps")) {
    if (entry.path().extension() != ".yaml") continue;
    ++maps;
    std::vector<PanelMap> panels;
    ASSERT_NO_THROW(panels = readPanelMaps(entry.path())) << entry.path();
    for (const PanelMap& panel : panels)
      EXPECT_LT(surfaceOf(panel).triangles.size(), 6000U) << "a renderer's frame rate depends on it";
  }
  EXPECT_GE(maps, 5);
}

TEST(PanelMap, DexrovPanelStandsOnTheSeaFloorOfTheShippedDive) {
  const PanelMap map = readPanelMap(fs::path(FATHOM_SOURCE_DIR) / "maps/dexrov/panel.yaml");
  EXPECT_EQ(map.markers.size(), 12U);
  EXPECT_EQ(map.handles.size(), 9U);
  const Matrix3d& R = map.T_odom_panel.rotation;
  EXPECT_LT((R.col(2) - Vector3d(-1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((R.col(1) - Vector3d(0, 0, 1)).norm(), 1e-12);
  double lowest_z = 0.0;
  for (const auto& v : map.body.vertices)
    lowest_z = std::min(lowest_z, (map.T_odom_panel * Vector3d(v.position.cast<double>())).z());
  EXPECT_NEAR(lowest_z, -6.0, 1e-6);
}

TEST(PanelMap, SampleOfAnIndependentGeneratorIsRead) {
  FATHOM_NEEDS_SHARED("data/sample/none/panel/panel.yaml");
  const PanelMap map = readPanelMap(test::sharedData("data/sample/none/panel/panel.yaml"));
  EXPECT_EQ(map.markers.size(), 12U);
  EXPECT_EQ(map.handles.size(), 4U);
  EXPECT_EQ(map.materials, std::vector<std::string>{"panel_yellow"})
      << "its handles are in the mesh, by name";
  EXPECT_EQ(map.components, 1);
}

}  // namespace
}  // namespace fathom
