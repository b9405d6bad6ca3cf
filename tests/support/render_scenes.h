#pragma once

#include <cmath>
#include <opencv2/core.hpp>

#include "core/random.h"
#include "panel/marker_family.h"
#include "render/renderer.h"
#include "render/sea_floor.h"

/// Scenes for the renderer's tests, and views of them.
namespace fathom::test {

CameraModel rovCamera();

/// Width along x and height along y, m, facing z.
Surface rectangle(double width, double height, const Eigen::Vector3f& albedo);

/// Along z, both ends open, with a smooth side.
Surface tube(double radius, double length, const Eigen::Vector3f& albedo, std::uint32_t sides = 24);

/// A fiducial as the face shows it: cell by cell, in a white margin of one cell.
Surface markerSurface(const std::string& family, int id, double size_m);

/// Panel frame: an 1.6 x 1.2 m face with 28 fiducials 1 mm in front of it and nine knobs; 5000 triangles.
Surface panelSurface();

/// The panel stands upright with its face towards -x, its middle at `position_odom`.
Pose facingPanel(const Vector3d& position_odom);

/// A camera at `from` that looks at `at`, upright.
Pose lookingAt(const Vector3d& from_odom, const Vector3d& at_odom);

inline const Vector3d kPanelPosition_odom(6.0, 0.0, -1.2);

/// Panel and sea floor, odom frame; 7900 triangles.
Surface panelOnSeaFloor();

/// Two lamps beside the camera, 32 degrees half angle, turned a little inwards.
Lighting lampsBeside(const Pose& T_odom_camera, float ambient, float irradiance_1m);

}  // namespace fathom::test
