#include "corners.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "manipulator.h"
#include "ordinary.h"

namespace fathom::sealed {
namespace {

constexpr double kMargin_px = 4;         // to the image's border: a detector needs white all round
constexpr double kShortestSide_px = 16;  // of a marker of seven cells that is still read
constexpr double kLeastCosine = 0.3;     // of the angle from which a marker is seen
constexpr double kNearestOutlier_px = 2, kFarthestOutlier_px = 8;
constexpr int kHiddenPoints = 4;  // of the sixteen around a marker that is still read with an arm before it

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

/// White has grown over the black square by so much along each edge: where the moved edges cross.
Corners shrunk(const Corners& corners, double growth_px) {
  if (growth_px == 0) return corners;
  const Vector2d middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
  std::array<Eigen::Vector3d, 4> edges;  // lines, edge i from corner i to the next
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d along = (corners[(i + 1) % 4] - corners[i]).normalized();
    Vector2d inwards(-along.y(), along.x());
    if (inwards.dot(middle - corners[i]) < 0) inwards = -inwards;
    edges[i] << inwards, -inwards.dot(corners[i]) - growth_px;
  }
  Corners moved;
  for (std::size_t i = 0; i < 4; ++i) moved[i] = edges[(i + 3) % 4].cross(edges[i]).hnormalized();
  return moved;
}

/// With an arm before the marker: not read, or the one corner that is hidden is taken to be where one of its
/// edges goes out of sight.
bool readBehind(const Arm& arm, const std::array<Vector3d, 4>& corners_camera, Corners& corners,
                Random& random) {
  int hidden_points = 0, hidden_corners = 0;
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (int step = 0; step < 4; ++step) {
      const double along = step / 4.0;
      if (!arm.hides((1 - along) * corners_camera[i] + along * corners_camera[(i + 1) % 4])) continue;
      ++hidden_points;
      if (step > 0) continue;
      ++hidden_corners;
      hidden = i;
    }
  const double cut = random.uniform(0.1, 0.25), chance = random.uniform();
  if (hidden_points == 0) return true;
  if (hidden_corners != 1 || hidden_points > kHiddenPoints || chance < 0.5) return false;
  corners[hidden] += cut * (corners[(hidden + (chance < 0.75 ? 1 : 3)) % 4] - corners[hidden]);
  return true;
}

/// Measures markers one after the other, image by image.
class CornerDetector {
 public:
  CornerDetector(const Vehicle& vehicle, const SealedCase& sealed, const TruePanel& panel,
                 const Viewpoint& viewpoint)
      : vehicle_(vehicle),
        sealed_(sealed),
        panel_(panel),
        viewpoint_(viewpoint),
        noise_(stream(sealed.seed, Stream::corners)),
        outliers_(stream(sealed.seed, Stream::corner_outliers)),
        hidden_(stream(sealed.seed, Stream::hidden_corners)) {}

  std::optional<Corners> measured(const Marker& marker, const TrueCamera& camera, double stamp_s);

 private:
  double edgeGrowthOf_px(const Marker& marker, double stamp_s) const;
  bool readBehindArm(const std::array<Vector3d, 4>& corners_odom, Corners& corners, double stamp_s);

  const Vehicle& vehicle_;
  const SealedCase& sealed_;
  const TruePanel& panel_;
  const Viewpoint& viewpoint_;
  Random noise_, outliers_, hidden_;
};

double CornerDetector::edgeGrowthOf_px(const Marker& marker, double stamp_s) const {
  const double all_px = sealed_.number("edge-bias", "offset_px", stamp_s) + ordinaryEdgeGrowth_px(sealed_);
  if (sealed_.ordinary == 0) return all_px;
  Random random = streamOf(sealed_.seed, Stream::edges, static_cast<std::uint64_t>(marker.id));
  return all_px + sealed_.ordinary * kOrdinary.marker_edge_px * random.normal();
}

bool CornerDetector::readBehindArm(const std::array<Vector3d, 4>& corners_odom, Corners& corners,
                                   double stamp_s) {
  const auto arm = armAt(sealed_, vehicle_, stamp_s);
  if (!arm) return true;
  auto corners_camera = corners_odom;
  const Pose T_camera_odom = viewpoint_.T_odom_camera(viewpoint_.trueTime_s(stamp_s), stamp_s).inverse();
  for (Vector3d& corner : corners_camera) corner = T_camera_odom * corner;
  return readBehind(*arm, corners_camera, corners, hidden_);
}

std::optional<Corners> CornerDetector::measured(const Marker& marker, const TrueCamera& camera,
                                                double stamp_s) {
  auto corners_odom = panel_.corners_panel(marker, stamp_s);
  for (Vector3d& corner : corners_odom) corner = panel_.T_odom_panel(stamp_s) * corner;
  auto corners = seenCorners(vehicle_, corners_odom, viewpoint_, camera, stamp_s);
  if (!corners || !readBehindArm(corners_odom, *corners, stamp_s)) return std::nullopt;
  *corners = shrunk(*corners, edgeGrowthOf_px(marker, stamp_s));
  for (Vector2d& corner : *corners) {
    for (double& coordinate_px : corner)
      if (sealed_.noise) coordinate_px += vehicle_.camera.corner_sigma_px * cornerNoise(sealed_.rich, noise_);
    corner +=
        outlier<2>(sealed_.ordinary * kOrdinary.outliers, kNearestOutlier_px, kFarthestOutlier_px, outliers_);
  }
  return corners;
}

}  // namespace

std::string imageName(std::size_t index) { return print("CAMERA_%04zu.png", index); }

std::string cornersTable(const Vehicle& vehicle, const SealedCase& sealed, const TruePanel& panel,
                         const Viewpoint& viewpoint, const std::vector<double>& stamps_s) {
  CornerDetector detector(vehicle, sealed, panel, viewpoint);
  std::string table = "image,family,id,sigma_px,x0_px,y0_px,x1_px,y1_px,x2_px,y2_px,x3_px,y3_px\n";
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    const TrueCamera camera(vehicle.camera, sealed, stamps_s[i]);
    for (const Marker& marker : panel.map().markers) {
      const auto corners = detector.measured(marker, camera, stamps_s[i]);
      if (!corners) continue;
      table += imageName(i) + "," + marker.family + "," + std::to_string(marker.id) + "," +
               shortest(vehicle.camera.corner_sigma_px);
      for (const Vector2d& corner : *corners)
        for (const double coordinate_px : corner) table += print(",%.5f", coordinate_px);
      table += "\n";
    }
  }
  return table;
}

}  // namespace fathom::sealed
