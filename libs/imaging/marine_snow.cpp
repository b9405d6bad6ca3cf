#include "imaging/marine_snow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "imaging/image_model.h"

namespace fathom {
namespace {

constexpr double kFlakeRadius_m = kFlakeDiameter_m / 2;
constexpr double kFaintest = 0.5 / 255;  // change of a pixel, share of full scale

/// Integral from 0 to x of what is below y of the disc about 0, counted from its middle line: of
/// clamp(y, -s, s) with s = sqrt(r² - x²).
double belowLine(double x, double y, double r) {
  const double across = std::min(std::abs(x), r), height = std::clamp(y, -r, r);
  const double flat = std::min(across, std::sqrt(std::max(0.0, r * r - height * height)));
  const auto segment = [&](double a) {
    return 0.5 * (a * std::sqrt(std::max(0.0, r * r - a * a)) + r * r * std::asin(std::min(1.0, a / r)));
  };
  const double area = height * flat + std::copysign(segment(across) - segment(flat), height);
  return x < 0 ? -area : area;
}

/// The pixels that a disc may cover, cut to the image.
cv::Rect pixelsOf(const Vector2d& centre_px, double radius_px, const cv::Size& image) {
  const cv::Point first(static_cast<int>(std::floor(centre_px.x() - radius_px + 0.5)),
                        static_cast<int>(std::floor(centre_px.y() - radius_px + 0.5)));
  const cv::Point last(static_cast<int>(std::floor(centre_px.x() + radius_px + 0.5)),
                       static_cast<int>(std::floor(centre_px.y() + radius_px + 0.5)));
  return cv::Rect(first, last + cv::Point(1, 1)) & cv::Rect({}, image);
}

/// From which range on a flake changes no pixel by much, whatever is behind it.
double faintFrom_m(const CameraModel& camera, const Environment& environment) {
  const double area = std::numbers::pi * kFlakeRadius_m * kFlakeRadius_m * camera.fx_px * camera.fy_px;
  const Vector3d brightest = (kFlakeReflectance * environment.ambient).cwiseMax(environment.water.veil);
  const Water without_veil{environment.water.attenuation_per_m, Vector3d::Zero()};
  const auto change = [&](double z_m) {
    const Vector3d arriving = predictLight<double>(brightest, z_m, z_m, without_veil, {});
    return std::min(1.0, area / (z_m * z_m)) * arriving.maxCoeff();
  };
  double near = kNearestFlake_m, far = 1000;
  while (far - near > 0.01) {
    const double middle = 0.5 * (near + far);
    (change(middle) > kFaintest ? near : far) = middle;
  }
  return far;
}

double farthest(const cv::Mat& z_m) {
  float largest = 0;
  for (int v = 0; v < z_m.rows; ++v)
    largest = std::max(largest, *std::max_element(z_m.ptr<float>(v), z_m.ptr<float>(v) + z_m.cols));
  return largest;
}

/// Of ideal image coordinates: what the image shows, with as much around it as the nearest flake reaches.
Eigen::AlignedBox2d fieldOf(const CameraModel& camera) {
  constexpr int kSteps = 32;  // along each edge
  Eigen::AlignedBox2d field;
  const double right = camera.width_px - 0.5, bottom = camera.height_px - 0.5;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = -0.5 + i * (right + 0.5) / kSteps, y = -0.5 + i * (bottom + 0.5) / kSteps;
    for (const Vector2d& pixel :
         {Vector2d(x, -0.5), Vector2d(x, bottom), Vector2d(-0.5, y), Vector2d(right, y)})
      field.extend(camera.idealAt(pixel));
  }
  const Vector2d reach = Vector2d::Constant(kFlakeRadius_m / kNearestFlake_m);
  return {field.min() - reach, field.max() + reach};
}

/// In order of range, near ones first: of a Poisson process the volumes from one to the next are distributed
/// exponentially.
std::vector<Vector3d> strewn(const Eigen::AlignedBox2d& field, double far_m, double per_m3, Random& random) {
  const double third = field.volume() / 3, near_cubed = std::pow(kNearestFlake_m, 3);
  std::vector<Vector3d> flakes;
  for (double volume_m3 = 0;;) {
    volume_m3 -= std::log(1.0 - random.uniform()) / per_m3;
    const double z_m = std::cbrt(near_cubed + volume_m3 / third);
    if (z_m >= far_m) return flakes;
    const double x = random.uniform(field.min().x(), field.max().x());
    const double y = random.uniform(field.min().y(), field.max().y());
    flakes.emplace_back(z_m * x, z_m * y, z_m);
  }
}

double below(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }  // of a standard normal

/// How many pixels of a disc are found, by radius and contrast in units of a pixel's noise. Which of them are
/// found is each one's own chance, and they are taken to lie side by side.
class SpeckTable {
 public:
  static const SpeckTable& instance() {
    static const SpeckTable table;
    return table;
  }

  /// Probability of each number from 1 on; the rest is that of none.
  BySpeckPixels at(double radius_px, double contrast) const {
    const double i = placeOf(radius_px, kSmallest_px, kRadii),
                 j = placeOf(contrast, kFaintestContrast, kContrasts);
    if (contrast < kFaintestContrast) return BySpeckPixels::Zero();
    const int row = static_cast<int>(i), column = static_cast<int>(j);
    const double down = i - row, right = j - column;
    return (1 - down) * ((1 - right) * cell(row, column) + right * cell(row, column + 1)) +
           down * ((1 - right) * cell(row + 1, column) + right * cell(row + 1, column + 1));
  }

 private:
  static constexpr int kRadii = 64, kContrasts = 56, kPlaces = 8;  // places: of the middle, in half a pixel
  static constexpr double kStep = 0.1;                             // of logarithms
  static constexpr double kSmallest_px = 0.03, kFaintestContrast = 4;

  SpeckTable() : cells_(kRadii * kContrasts, BySpeckPixels::Zero()) {
    for (int row = 0; row < kRadii; ++row)
      for (int k = 0; k < kPlaces * kPlaces; ++k) {
        const int across = k % kPlaces, down = k / kPlaces;
        const Vector2d middle(0.5 * (across + 0.5) / kPlaces, 0.5 * (down + 0.5) / kPlaces);
        const std::vector<double> covered = sharesOf(middle, kSmallest_px * std::exp(kStep * row));
        for (int column = 0; column < kContrasts; ++column)
          cells_[static_cast<std::size_t>(row * kContrasts + column)] +=
              found(covered, kFaintestContrast * std::exp(kStep * column)) / (kPlaces * kPlaces);
      }
  }

  static double placeOf(double value, double first, int count) {
    return std::clamp(std::log(value / first) / kStep, 0.0, count - 1.001);
  }
  const BySpeckPixels& cell(int row, int column) const {
    return cells_[static_cast<std::size_t>(row * kContrasts + column)];
  }

  static std::vector<double> sharesOf(const Vector2d& middle, double radius_px) {
    std::vector<double> shares;
    const int reach = static_cast<int>(radius_px + 1.5);
    for (int v = -reach; v <= reach; ++v)
      for (int u = -reach; u <= reach; ++u)
        if (const double share = coveredShare(Vector2d(u, v), middle, radius_px); share > 0)
          shares.push_back(share);
    return shares;
  }

  /// One pixel after the other, the distribution of how many so far.
  static BySpeckPixels found(const std::vector<double>& covered, double contrast) {
    Eigen::Array<double, kSpeckPixels + 1, 1> probability = Eigen::Array<double, kSpeckPixels + 1, 1>::Zero();
    probability[0] = 1;
    for (const double share : covered) {
      const double p = below(share * contrast - kSpeckSigmas);
      for (int n = kSpeckPixels; n > 0; --n)
        probability[n] = probability[n] * (n == kSpeckPixels ? 1 : 1 - p) + probability[n - 1] * p;
      probability[0] *= 1 - p;
      if (probability[kSpeckPixels] > 1 - 1e-9) break;
    }
    return probability.tail<kSpeckPixels>();
  }

  std::vector<BySpeckPixels> cells_;
};

/// One colour's contrast that is found as often as any of three: at the share where that is one half. All in
/// units of the noise.
double contrastOf(const Vector3d& colours) {
  const double largest = colours.maxCoeff();
  if (largest <= 0) return 0;
  double low = 0.5 * kSpeckSigmas / largest, high = kSpeckSigmas / largest;
  for (int round = 0; round < 12; ++round) {
    const double share = 0.5 * (low + high);
    double none = 1;
    for (int c = 0; c < 3; ++c) none *= below(kSpeckSigmas - share * colours[c]);
    (none > 0.5 ? low : high) = share;
  }
  return kSpeckSigmas / high;
}

}  // namespace

Vector3d flakeLight(double z_m, const Environment& environment) {
  const Vector3d scene = kFlakeReflectance * environment.ambient;
  return predictLight<double>(scene, z_m, z_m, environment.water, {});
}

double focalAt(const Vector2d& ideal, const CameraModel& camera) {
  constexpr double kStep = 1e-5;
  const Vector2d dx(kStep, 0), dy(0, kStep);
  Eigen::Matrix2d J;
  J << camera.distort<double>(ideal + dx) - camera.distort<double>(ideal - dx),
      camera.distort<double>(ideal + dy) - camera.distort<double>(ideal - dy);
  const double area = camera.fx_px * camera.fy_px * J.determinant() / (4 * kStep * kStep);
  return std::copysign(std::sqrt(std::abs(area)), area);
}

double coveredShare(const Vector2d& pixel, const Vector2d& centre_px, double radius_px) {
  const Vector2d low = pixel - centre_px - Vector2d::Constant(0.5), high = low + Vector2d::Ones();
  const double area = belowLine(high.x(), high.y(), radius_px) - belowLine(low.x(), high.y(), radius_px) -
                      belowLine(high.x(), low.y(), radius_px) + belowLine(low.x(), low.y(), radius_px);
  return std::clamp(area, 0.0, 1.0);
}

void drawSnow(cv::Mat& light, const cv::Mat& z_m, const CameraModel& camera, const Environment& environment,
              double per_m3, Random random) {
  if (per_m3 <= 0) return;
  const double far_m = std::min(farthest(z_m), faintFrom_m(camera, environment));
  std::vector<Vector3d> flakes = strewn(fieldOf(camera), far_m, per_m3, random);
  std::reverse(flakes.begin(), flakes.end());  // near ones hide far ones
  for (const Vector3d& flake : flakes) {
    const double focal_px = focalAt(flake.head<2>() / flake.z(), camera);
    if (focal_px <= 0) continue;
    const Vector2d centre_px = camera.project<double>(flake);
    const double radius_px = focal_px * kFlakeRadius_m / flake.z();
    const Vector3d own = flakeLight(flake.z(), environment);
    const cv::Vec3f colour = cv::Vec3d(own[0], own[1], own[2]);
    const cv::Rect pixels = pixelsOf(centre_px, radius_px, light.size());
    for (int v = pixels.y; v < pixels.br().y; ++v)
      for (int u = pixels.x; u < pixels.br().x; ++u) {
        if (flake.z() >= z_m.at<float>(v, u)) continue;
        auto& there = light.at<cv::Vec3f>(v, u);
        there += static_cast<float>(coveredShare(Vector2d(u, v), centre_px, radius_px)) * (colour - there);
      }
  }
}

int speckClass(int pixels) { return pixels < 4 ? 0 : pixels < kSpeckPixels ? 1 : 2; }

BySpeckPixels visibleVolume(const Backdrop& backdrop, const Environment& environment) {
  BySpeckPixels volume_m3 = BySpeckPixels::Zero();
  if (backdrop.z_m <= kNearestFlake_m) return volume_m3;
  constexpr double kLongestStep = 0.06;  // of the logarithm of z
  const double span = std::log(backdrop.z_m / kNearestFlake_m);
  const int steps = static_cast<int>(std::ceil(span / kLongestStep));
  for (int i = 0; i < steps; ++i) {
    const double z_m = kNearestFlake_m * std::exp((i + 0.5) * span / steps);
    const Vector3d off = flakeLight(z_m, environment) - backdrop.light;
    const double radius_px = backdrop.focal_px * kFlakeRadius_m / z_m;
    const double contrast = contrastOf(off.cwiseAbs().cwiseQuotient(backdrop.sigma));
    volume_m3 += z_m * z_m * z_m * span / steps * SpeckTable::instance().at(radius_px, contrast);
  }
  return volume_m3 / (backdrop.focal_px * backdrop.focal_px);
}

/// Two specks of m and n pixels touch, at corners too, at (sqrt(m) + sqrt(n) + 1)² of their relative places:
/// squares do. Then there is one, which is either of them where their class is the same.
void SpeckVolumes::add(const BySpeckPixels& volume_m3, const BySpeckClass& pixels) {
  constexpr double kUsualSideOfLarge_px = 5.3;  // of 16 pixels or more
  const auto side = [](int n) { return n < kSpeckPixels ? std::sqrt(n) : kUsualSideOfLarge_px; };
  for (int m = 1; m <= kSpeckPixels; ++m) {
    visible_m3[speckClass(m)] += pixels[speckClass(m)] * volume_m3[m - 1];
    for (int n = 1; n <= m; ++n) {
      const double touch = side(m) + side(n) + 1;
      const double pairs_m6 = (m == n ? 0.5 : 1.0) * volume_m3[m - 1] * volume_m3[n - 1] * touch * touch;
      const int larger = speckClass(m), smaller = speckClass(n), both = speckClass(m + n);
      merging_m6[smaller] += pixels[smaller] * pairs_m6;
      if (larger == both) continue;
      merging_m6[larger] += pixels[larger] * pairs_m6;
      merged_m6[both] += pixels[both] * pairs_m6;
    }
  }
}

SpeckVolumes& SpeckVolumes::operator+=(const SpeckVolumes& other) {
  visible_m3 += other.visible_m3;
  merging_m6 += other.merging_m6;
  merged_m6 += other.merged_m6;
  return *this;
}

}  // namespace fathom
