#include "drifting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "streams.h"

namespace fathom::sealed {
namespace {

constexpr double kCell_m = 0.5;
constexpr double kNearest_m = 0.15, kFarthest_m = 7.0;
constexpr double kFlake_m = 0.003;  // root mean square diameter
constexpr double kFlakeLogSpread =
    0.1;  // of diameters, log-normal: nearly of the one size that the density is of
constexpr double kFlakeAlbedo = 0.5;
const Vector3d kDrift_odom_m_s(0.01, 0.02, -0.002);
constexpr double kWidestSlope = 0.75;  // of lines of sight to the optical axis, image corners included

int poisson(double mean, Random& random) {
  int count = 0;
  for (double product = random.uniform(); product > std::exp(-mean); product *= random.uniform()) ++count;
  return count;
}

/// Covers a disc, the share of each pixel that is behind it, in all as much as the disc's area.
void cover(cv::Mat3f& light, const Vector2d& middle, double radius_px, const cv::Vec3f& colour,
           const cv::Mat1f* depth_m, double at_m) {
  const int reach = static_cast<int>(std::ceil(radius_px + 1));
  const int x0 = static_cast<int>(std::lround(middle.x())), y0 = static_cast<int>(std::lround(middle.y()));
  const auto softDisc = [&](int x, int y) {
    return std::clamp(std::max(radius_px, 0.5) + 0.5 - (Vector2d(x, y) - middle).norm(), 0.0, 1.0);
  };
  double sum = 0;
  for (int y = y0 - reach; y <= y0 + reach; ++y)
    for (int x = x0 - reach; x <= x0 + reach; ++x) sum += softDisc(x, y);
  const double area_px = std::numbers::pi * radius_px * radius_px;
  for (int y = std::max(0, y0 - reach); y <= std::min(light.rows - 1, y0 + reach); ++y)
    for (int x = std::max(0, x0 - reach); x <= std::min(light.cols - 1, x0 + reach); ++x) {
      if (depth_m && (*depth_m)(y, x) < at_m) continue;
      const auto covered = static_cast<float>(std::min(1.0, softDisc(x, y) * area_px / sum));
      light(y, x) = (1 - covered) * light(y, x) + covered * colour;
    }
}

class Snowfall {
 public:
  Snowfall(const View& view, const Picture& picture, cv::Mat3f& light)
      : view_(view),
        picture_(picture),
        light_(light),
        camera_(view.camera, view.sealed, view.stamp_s),
        middle_s_(view.viewpoint.rowTime_s(view.camera.height_px / 2.0, view.stamp_s)),
        T_camera_odom_(view.viewpoint.T_odom_camera(middle_s_, view.stamp_s).inverse()),
        mean_per_cell_(view.sealed.number("marine-snow", "particles_per_m3", view.stamp_s) *
                       std::pow(kCell_m, 3)) {}

  /// All cells around the camera that it may see.
  void fall() {
    if (mean_per_cell_ <= 0) return;
    const Vector3d camera_odom = T_camera_odom_.inverse().position - kDrift_odom_m_s * middle_s_;
    const Eigen::Array3i from = ((camera_odom.array() - kFarthest_m) / kCell_m).floor().cast<int>();
    const Eigen::Array3i to = ((camera_odom.array() + kFarthest_m) / kCell_m).floor().cast<int>();
    for (int x = from.x(); x <= to.x(); ++x)
      for (int y = from.y(); y <= to.y(); ++y)
        for (int z = from.z(); z <= to.z(); ++z) fallIn({x, y, z});
    addFarOnes();
  }

 private:
  /// The same flakes whenever the cell is seen.
  void fallIn(const Eigen::Vector3i& cell) {
    const Vector3d low_odom = cell.cast<double>() * kCell_m + kDrift_odom_m_s * middle_s_;
    const Vector3d middle_camera = T_camera_odom_ * (low_odom + Vector3d::Constant(kCell_m / 2));
    const double around_m = kCell_m * 0.87, depth_m = middle_camera.z() + around_m;  // half a cell's diagonal
    if (depth_m < kNearest_m || middle_camera.head<2>().norm() > kWidestSlope * depth_m + around_m) return;
    const auto number = [](int i) { return static_cast<std::uint64_t>(i + 0x8000) & 0xffffU; };
    Random random =
        stream(view_.sealed.seed, Stream::snow,
               std::uint64_t{1} << 60 | number(cell.x()) << 32 | number(cell.y()) << 16 | number(cell.z()));
    for (int left = poisson(mean_per_cell_, random); left > 0; --left) {
      const double x = random.uniform(), y = random.uniform(), z = random.uniform();
      const double diameter_m =
          kFlake_m * std::exp(kFlakeLogSpread * random.normal() - kFlakeLogSpread * kFlakeLogSpread);
      draw(T_camera_odom_ * (low_odom + kCell_m * Vector3d(x, y, z)), diameter_m);
    }
  }

  /// Those farther off are much smaller than a pixel: what they change on average, where there is but water.
  void addFarOnes() {
    constexpr double kStep_m = 0.5, kEnd_m = 60;
    const double covered_per_m =
        mean_per_cell_ / std::pow(kCell_m, 3) * std::numbers::pi / 4 * kFlake_m * kFlake_m;
    const WaterLight& water = view_.water;
    Array3d change = Array3d::Zero();
    for (double at_m = kFarthest_m + kStep_m / 2; at_m < kEnd_m; at_m += kStep_m)
      change +=
          covered_per_m * kStep_m *
          (kFlakeAlbedo * water.daylight * water.transmission(at_m) + water.veilBefore(at_m) - water.veil);
    const cv::Scalar far_ones(change.x(), change.y(), change.z());
    cv::add(light_, far_ones, light_, picture_.depth_m > kEnd_m);
  }

  void draw(const Vector3d& flake_camera, double diameter_m) {
    const double range_m = flake_camera.norm();
    if (flake_camera.z() < kNearest_m || range_m > kFarthest_m) return;
    const auto pixel = camera_.pixelOf(flake_camera);
    if (!pixel || (pixel->array() < -50).any() || (pixel->array() > 1000).any()) return;
    const WaterLight& water = view_.water;
    const double path_m = water.path_m(flake_camera.z(), range_m);
    const Array3d irradiance = water.daylight + view_.lamps.irradianceAt(flake_camera);
    const Array3d seen = kFlakeAlbedo * irradiance * water.transmission(path_m) + water.veilBefore(path_m) +
                         view_.lamps.glow(*pixel, range_m);
    cover(light_, *pixel, view_.camera.fx_px * diameter_m / 2 / flake_camera.z(),
          {static_cast<float>(seen.x()), static_cast<float>(seen.y()), static_cast<float>(seen.z())},
          &picture_.depth_m, flake_camera.z());
  }

  const View& view_;
  const Picture& picture_;
  cv::Mat3f& light_;
  TrueCamera camera_;
  double middle_s_;
  Pose T_camera_odom_;
  double mean_per_cell_;
};

}  // namespace

void addSnow(const View& view, const Picture& picture, cv::Mat3f& light) {
  Snowfall(view, picture, light).fall();
}

/// A bubble mirrors what is bright at its rim (total reflection), and is clear in its middle.
void addBubbles(double count, Random& random, const WaterLight& water, cv::Mat3f& light) {
  const Array3d bright = 0.8 * water.daylight;
  const cv::Vec3f colour(static_cast<float>(bright.x()), static_cast<float>(bright.y()),
                         static_cast<float>(bright.z()));
  for (int left = poisson(count, random); left > 0; --left) {
    const double x = random.uniform(0, light.cols), y = random.uniform(0, light.rows);
    const double radius_px = random.uniform(3, 10);
    const cv::Rect box(static_cast<int>(x - radius_px / 2), static_cast<int>(y - radius_px / 2),
                       static_cast<int>(radius_px), static_cast<int>(radius_px));
    const cv::Rect inside = box & cv::Rect(0, 0, light.cols, light.rows);
    const cv::Mat3f behind = light(inside).clone();
    cover(light, {x, y}, radius_px, colour, nullptr, 0);
    behind.copyTo(light(inside));
  }
}

}  // namespace fathom::sealed
