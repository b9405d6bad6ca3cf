#include "corners.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "streams.h"

namespace fathom::sealed {
namespace {

constexpr double kMargin_px = 4;         // to the image's border: a detector needs white all round
constexpr double kShortestSide_px = 16;  // of a marker of seven cells that is still read
constexpr double kLeastCosine = 0.3;     // of the angle from which a marker is seen

using Corners = std::array<Vector2d, 4>;

/// Normal; in a rich recording Student's t with four degrees of freedom (as heavy-tailed as detectors are),
/// scaled to the same standard deviation.
double cornerNoise(bool heavy_tailed, Random& random) {
  const double normal = random.normal();
  if (!heavy_tailed) return normal;
  double chi_square = 0;
  for (int i = 0; i < 4; ++i) chi_square += std::pow(random.normal(), 2);
  return normal / std::sqrt(chi_square / 4) / std::sqrt(2.0);
}

bool findable(const Corners& corners, const Camera& camera) {
  double shortest_side_px = 1e9;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d& c = corners[i];
    if (c.x() < kMargin_px || c.y() < kMargin_px || c.x() > camera.width_px - 1 - kMargin_px ||
        c.y() > camera.height_px - 1 - kMargin_px)
      return false;
    shortest_side_px = std::min(shortest_side_px, (c - corners[(i + 1) % 4]).norm());
  }
  return shortest_side_px > kShortestSide_px;
}

bool facesCamera(const std::array<Vector3d, 4>& corners_odom, const Vector3d& camera_odom) {
  const Vector3d normal = (corners_odom[0] - corners_odom[3]).cross(corners_odom[3] - corners_odom[2]);
  const Vector3d to_camera = camera_odom - corners_odom[0];
  return to_camera.dot(normal) > kLeastCosine * to_camera.norm() * normal.norm();
}

std::optional<Corners> seenCorners(const Vehicle& vehicle, const std::array<Vector3d, 4>& corners_odom,
                                   const Viewpoint& viewpoint, const TrueCamera& camera, double stamp_s) {
  if (!facesCamera(corners_odom, viewpoint.T_odom_camera(stamp_s, stamp_s).position)) return std::nullopt;
  Corners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = viewpoint.pixelOf(camera, corners_odom[i], stamp_s);
    if (!pixel) return std::nullopt;
    corners[i] = *pixel;
  }
  if (!findable(corners, vehicle.camera)) return std::nullopt;
  return corners;
}

}  // namespace

std::string imageName(std::size_t index) { return print("CAMERA_%04zu.png", index); }

std::string cornersTable(const Vehicle& vehicle, const SealedCase& sealed, const TruePanel& panel,
                         const Viewpoint& viewpoint, const std::vector<double>& stamps_s) {
  Random random = stream(sealed.seed, Stream::corners);
  const double sigma_px = vehicle.camera.corner_sigma_px;
  std::string table = "image,family,id,sigma_px,x0_px,y0_px,x1_px,y1_px,x2_px,y2_px,x3_px,y3_px\n";
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    const TrueCamera camera(vehicle.camera, sealed, stamps_s[i]);
    const Pose T_odom_panel = panel.T_odom_panel(stamps_s[i]);
    for (const Marker& marker : panel.map().markers) {
      auto corners_odom = panel.corners_panel(marker, stamps_s[i]);
      for (Vector3d& corner : corners_odom) corner = T_odom_panel * corner;
      const auto corners = seenCorners(vehicle, corners_odom, viewpoint, camera, stamps_s[i]);
      if (!corners) continue;
      table +=
          imageName(i) + "," + marker.family + "," + std::to_string(marker.id) + "," + shortest(sigma_px);
      for (const Vector2d& corner : *corners)
        for (const double coordinate_px : {corner.x(), corner.y()}) {
          const double noise_px = sealed.noise ? sigma_px * cornerNoise(sealed.rich, random) : 0.0;
          table += print(",%.5f", coordinate_px + noise_px);
        }
      table += "\n";
    }
  }
  return table;
}

}  // namespace fathom::sealed
