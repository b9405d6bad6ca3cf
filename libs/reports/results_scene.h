#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/uncertain_pose.h"
#include "panel/panel_map.h"

namespace fathom {

/// A way of the robot, as one task estimates it.
struct NamedPath {
  struct Point {
    double t_s = 0;
    UncertainPose T_odom_robot;  ///< of a reference: its covariance zero
  };
  std::string name;
  std::array<std::uint8_t, 3> colour;  ///< red green blue
  std::vector<Point> points;
};

struct ResultsScene {
  std::vector<PanelMap> panels;  ///< may be empty
  std::vector<NamedPath> paths;
  double ellipsoid_every_s = 10;  ///< of position, three sigma; none larger than 1.5 m
  CameraModel camera;
  std::vector<Pose> T_odom_camera;  ///< where panels were seen from: a frustum each
};

/// Writes a scene for MRPT's SceneViewer3D: panels as panelScene() draws them, paths in their colours with
/// their names at their ends, ellipsoids and frusta. The first panel, or odom where there is none, is in the
/// middle. Throws Error where the file cannot be written.
void writeResultsScene(const std::filesystem::path& file, const ResultsScene& results);

}  // namespace fathom
