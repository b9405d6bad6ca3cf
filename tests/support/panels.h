#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "core/files.h"
#include "panel/panel_map.h"
#include "support/shared_data.h"

namespace fathom::test {

/// A board of 1.0 x 0.6 x 0.04 m with its front at z = 0; the tests name its lines.
inline const std::string kBoardObj =
    "mtllib board.mtl\n"   // 1
    "o board\n"            // 2
    "usemtl yellow\n"      // 3
    "v -0.5 -0.3 -0.04\n"  // 4: vertex 1
    "v 0.5 -0.3 -0.04\n"   //
    "v -0.5 0.3 -0.04\n"   //
    "v 0.5 0.3 -0.04\n"    //
    "v -0.5 -0.3 0\n"      //
    "v 0.5 -0.3 0\n"       //
    "v -0.5 0.3 0\n"       //
    "v 0.5 0.3 0\n"        // 11: vertex 8
    "f 5 6 8 7\n"          // 12: front
    "f 2 1 3 4\n"          // 13: back
    "f 1 2 6\nf 1 6 5\n"   // 14: bottom
    "f 4 3 7 8\n"          // 16: top
    "f 2 4 8 6\n"          // 17: right
    "usemtl grey\n"        // 18
    "f 3 1 5 7\n";         // 19: left
inline const std::string kBoardMtl =
    "newmtl yellow\nKd 0.6 0.5 0.1\n\nnewmtl grey\nKa 0 0 0\nKd 0.2 0.2 0.25\n";

// clang-format off: the tests name lines
inline const std::string kBoardYaml = R"(panel: board
pose: {x: 6, y: 0.5, z: -4, yaw_deg: -90, pitch_deg: 0, roll_deg: 90}
pose_sigma: {position_m: 0.1, angle_deg: 2}
mesh: board.obj
markers:
  - {family: DICT_ARUCO_ORIGINAL, id: 7, size_m: 0.16, x: -0.3, y: 0.1, z: 0.001, rotation_deg: 0}
  - {family: tag36h11, id: 3, size_m: 0.16, x: 0.3, y: -0.1, z: 0.001, rotation_deg: 90}
handles:
  - {id: C3, kind: lever, x: 0.0, y: 0.1, z: 0.0, radius_m: 0.06, length_m: 0.10, range_deg: [0, 90], angle_deg: 30}
  - {id: A1, kind: wheel, x: 0.0, y: -0.1, z: 0.0, radius_m: 0.06, length_m: 0.12, range_deg: [-180, 180], angle_deg: -45}
)";
// clang-format on

/// `text` with its first `from` replaced by `to`.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the test's text has no " + from);
  return text.replace(at, from.size(), to);
}

/// Without writeTextFile(): a new file is not flushed to the disk, a replaced one is.
inline void writeNew(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::remove(file);
  std::ofstream(file, std::ios::binary) << text;
}

/// Files of the board above, or of a changed one.
struct BoardFiles {
  std::string yaml = kBoardYaml, obj = kBoardObj, mtl = kBoardMtl;

  /// Writes them into a folder; the map's path.
  std::filesystem::path write(const std::filesystem::path& folder) const {
    writeNew(folder / "board.obj", obj);
    writeNew(folder / "board.mtl", mtl);
    writeNew(folder / "board.yaml", yaml);
    return folder / "board.yaml";
  }
  PanelMap read() const { return readPanelMap(write(scratchFolder())); }
  /// The one line that reading complains with; empty where it does not.
  std::string complaint() const {
    try {
      read();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

}  // namespace fathom::test
