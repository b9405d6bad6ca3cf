#include "render/sea_floor.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fathom {
namespace {

constexpr int kCells = 38;  // along a side
constexpr int kOctaves = 6;
constexpr double kLargestPatch_m = 3.0;
constexpr double kPersistence = 0.7;

/// Random values on a square lattice, smoothly joined: Perlin's value noise, one octave.
class ValueNoise {
 public:
  ValueNoise(double side, double spacing, Random& random)
      : spacing_(spacing), count_(static_cast<std::size_t>(std::ceil(side / spacing)) + 2) {
    values_.resize(count_ * count_);
    for (double& value : values_) value = random.normal();
  }

  /// 0 <= x, y <= side.
  double at(double x, double y) const {
    const double column = std::floor(x / spacing_), row = std::floor(y / spacing_);
    const double u = smooth(x / spacing_ - column), v = smooth(y / spacing_ - row);
    const std::size_t i = static_cast<std::size_t>(row) * count_ + static_cast<std::size_t>(column);
    return (1 - v) * ((1 - u) * values_[i] + u * values_[i + 1]) +
           v * ((1 - u) * values_[i + count_] + u * values_[i + count_ + 1]);
  }

 private:
  static double smooth(double t) { return t * t * (3 - 2 * t); }

  double spacing_;
  std::size_t count_;
  std::vector<double> values_;
};

/// Octaves from large to small, scaled to a standard deviation of about 1.
class FractalNoise {
 public:
  FractalNoise(double side, Random& random) {
    double variance = 0;
    for (int k = 0; k < kOctaves; ++k) {
      octaves_.emplace_back(side, kLargestPatch_m / std::exp2(k), random);
      // Smooth interpolation of unit normals has a variance of (26/35)² on average.
      variance += std::pow(kPersistence, 2 * k) * (26.0 / 35.0) * (26.0 / 35.0);
    }
    scale_ = 1.0 / std::sqrt(variance);
  }

  double at(double x, double y) const {
    double sum = 0;
    for (std::size_t k = 0; k < octaves_.size(); ++k)
      sum += std::pow(kPersistence, static_cast<double>(k)) * octaves_[k].at(x, y);
    return scale_ * sum;
  }

 private:
  std::vector<ValueNoise> octaves_;
  double scale_ = 1;
};

/// Grid line 0 … kCells to 0 … 1, lines lying closer in the middle.
double gridLine(int k) {
  const double t = 2.0 * k / kCells - 1.0;
  return std::clamp(0.5 + 0.5 * (0.35 * t + 0.65 * t * t * t), 0.0, 1.0);
}

}  // namespace

Surface seaFloor(const SeaFloor& floor, Random random) {
  if (!(floor.side_m > 0) || !std::isfinite(floor.side_m))
    throw std::invalid_argument("a sea floor needs a positive side");
  const FractalNoise brightness(floor.side_m, random), tint(floor.side_m, random);
  Surface surface;
  for (int row = 0; row <= kCells; ++row)
    for (int column = 0; column <= kCells; ++column) {
      const double x = floor.side_m * gridLine(column), y = floor.side_m * gridLine(row);
      const double bright = 1.0 + floor.contrast * brightness.at(x, y);
      const double red = 0.2 * floor.contrast * tint.at(x, y);
      const Eigen::Array3d albedo =
          floor.mean_albedo.cast<double>().array() * bright * Eigen::Array3d(1.0 + red, 1.0, 1.0 - red);
      const Vector3d corner = Vector3d(x, y, 0) - 0.5 * floor.side_m * Vector3d(1, 1, 0);
      surface.vertices.push_back({(floor.centre_odom + corner).cast<float>(), Eigen::Vector3f::UnitZ(),
                                  albedo.max(0.02).min(0.9).matrix().cast<float>()});
    }
  for (std::uint32_t row = 0; row < kCells; ++row)
    for (std::uint32_t column = 0; column < kCells; ++column) {
      const std::uint32_t a = row * (kCells + 1) + column, b = a + 1, c = b + kCells + 1, d = c - 1;
      surface.triangles.push_back({a, b, c});
      surface.triangles.push_back({a, c, d});
    }
  return surface;
}

}  // namespace fathom
