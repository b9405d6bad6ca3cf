#include "panel_design.h"

#include <array>
#include <string>
#include <vector>

#include "core/files.h"
#include "core/geometry.h"
#include "core/text.h"

namespace fathom::sealed {
namespace {

constexpr double kPlateTop_m = 0.002, kMarkerTop_m = 0.003;
constexpr double kPlateMargin = 1.32;  // of a marker's side: a cell of white all round, and a little more

struct Placed {
  int id;
  double size_m, x_m, y_m, rotation_deg;
};
constexpr std::array<Placed, 12> kMarkers{{{17, 0.20, -0.64, 0.36, 0},
                                           {133, 0.16, -0.22, 0.36, 0},
                                           {211, 0.18, 0.21, 0.37, 90},
                                           {298, 0.16, 0.63, 0.35, 0},
                                           {347, 0.16, -0.62, 0.0, 0},
                                           {420, 0.20, -0.20, -0.01, 180},
                                           {511, 0.16, 0.22, 0.01, 0},
                                           {587, 0.18, 0.64, 0.0, 0},
                                           {666, 0.18, -0.64, -0.36, 270},
                                           {745, 0.16, -0.21, -0.37, 0},
                                           {871, 0.20, 0.20, -0.36, 0},
                                           {952, 0.16, 0.63, -0.36, 0}}};

constexpr const char* kMaterials =
    "newmtl board\nKd 0.58 0.47 0.15\n\nnewmtl plate\nKd 0.85 0.85 0.85\n\nnewmtl frame\nKd 0.24 0.24 "
    "0.26\n\n"
    "newmtl square\nKd 0.15 0.27 0.38\n\nnewmtl leg\nKd 0.33 0.34 0.34\n";

class ObjText {
 public:
  void box(const std::string& name, const std::string& material, const Vector3d& low, const Vector3d& high) {
    text_ += "o " + name + "\nusemtl " + material + "\n";
    for (int i = 0; i < 8; ++i)
      text_ += "v " + shortest(i & 1 ? high.x() : low.x()) + " " + shortest(i & 2 ? high.y() : low.y()) +
               " " + shortest(i & 4 ? high.z() : low.z()) + "\n";
    // Counter-clockwise seen from outside.
    for (const auto& face : {std::array{4, 5, 7, 6}, std::array{1, 0, 2, 3}, std::array{0, 1, 5, 4},
                             std::array{3, 2, 6, 7}, std::array{1, 3, 7, 5}, std::array{2, 0, 4, 6}}) {
      text_ += "f";
      for (const int corner : face) text_ += " " + std::to_string(first_ + corner);
      text_ += "\n";
    }
    first_ += 8;
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_ = "mtllib panel.mtl\n";
  int first_ = 1;  ///< OBJ counts from one
};

/// A flat box on the board: its square is `side_m` wide.
void addSquare(ObjText& obj, const std::string& name, const std::string& material, const Vector3d& middle,
               double side_m) {
  const Vector3d half(side_m / 2, side_m / 2, 0);
  obj.box(name, material, middle - half - Vector3d(0, 0, 0.001), middle + half + Vector3d(0, 0, kPlateTop_m));
}

std::string meshText(bool with_squares) {
  ObjText obj;
  const double w = kHalfWidth_m, h = kHalfHeight_m;
  obj.box("board", "board", {-w, -h, -0.03}, {w, h, 0});
  for (const Placed& m : kMarkers)
    addSquare(obj, "plate_" + std::to_string(m.id), "plate", {m.x_m, m.y_m, 0}, m.size_m * kPlateMargin);
  int squares = 0;
  for (const double x_m : {-0.42, 0.0, 0.42})
    for (const double y_m : {-0.18, 0.18})
      if (with_squares) addSquare(obj, "square_" + std::to_string(++squares), "square", {x_m, y_m, 0}, 0.10);
  obj.box("frame_left", "frame", {-w - 0.04, -h - 0.04, -0.03}, {-w, h + 0.04, 0.02});
  obj.box("frame_right", "frame", {w, -h - 0.04, -0.03}, {w + 0.04, h + 0.04, 0.02});
  obj.box("frame_top", "frame", {-w, h, -0.03}, {w, h + 0.04, 0.02});
  obj.box("frame_bottom", "frame", {-w, -h - 0.04, -0.03}, {w, -h, 0.02});
  const double foot = -(kFloorDepth_m + kPanelZ_m);
  obj.box("leg_left", "leg", {-0.6, foot, -0.08}, {-0.54, 0, -0.03});
  obj.box("leg_right", "leg", {0.54, foot, -0.08}, {0.6, 0, -0.03});
  return obj.text();
}

std::string mapText() {
  std::string text = print(
      "panel: panel\n"
      "pose: {x: %g, y: %g, z: %g, yaw_deg: -90, pitch_deg: 0, roll_deg: 90}\n"
      "pose_sigma: {position_m: 0, angle_deg: 0}\nmesh: panel.obj\nmarkers:\n",
      kPanelX_m, kPanelY_m, kPanelZ_m);
  for (const Placed& m : kMarkers)
    text += print(
        "  - {family: DICT_ARUCO_ORIGINAL, id: %d, size_m: %g, x: %g, y: %g, z: %g, rotation_deg: %g}\n",
        m.id, m.size_m, m.x_m, m.y_m, kMarkerTop_m, m.rotation_deg);
  return text;
}

}  // namespace

void writePanel(const std::filesystem::path& folder, bool with_squares) {
  writeTextFile(folder / "panel.mtl", kMaterials);
  writeTextFile(folder / "panel.obj", meshText(with_squares));
  writeTextFile(folder / "panel.yaml", mapText());
}

}  // namespace fathom::sealed
