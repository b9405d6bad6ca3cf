#include "observables/patches.h"

#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/linear_algebra.h"
#include "core/text.h"
#include "imaging/image_model.h"
#include "observables/rounding.h"

namespace fathom {
namespace {

/// exp(-a z) has the mean exp(-a (m - a s²/2)), with m and s² mean and variance of z, to second order.
constexpr double kUsualAttenuation_per_m = 0.25;
constexpr double kLeastCorrelation = 0.5;     // of albedo and reading within an image
constexpr double kSaturatedShare = 0.5;       // of patches, from which on the image counts as overexposed
constexpr double kDarkSigmas = 3;             // a mean nearer to 0 is biased by clipping there
constexpr std::size_t kFewestOfAnImage = 10;  // of an image
constexpr double kFewestOfAColour = 6;        // pixels: four numbers are fitted to them

/// What is summed over the pixels of a patch in one colour: column, row, albedo and light, and their
/// products.
struct ColourSums {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  Eigen::Matrix4d products = Eigen::Matrix4d::Zero();
  double pixels = 0, brightest = 0;

  void add(const Vector2d& where, double albedo, double light) {
    const Eigen::Vector4d pixel(where.x(), where.y(), albedo, light);
    ++pixels;
    sum += pixel;
    products += pixel * pixel.transpose();
    brightest = std::max(brightest, light);
  }
  /// What the light varies by about what goes with place and albedo, for that the mean has, and is no noise.
  double variance() const {
    constexpr double kNothing = 1e-12;  // by which an albedo varies that is the same all over
    const Eigen::Matrix4d scatter = products - sum * sum.transpose() / pixels;
    const Eigen::Matrix3d known = scatter.topLeftCorner<3, 3>() + kNothing * Eigen::Matrix3d::Identity();
    const Vector3d with_light = scatter.topRightCorner<3, 1>();
    return std::max(0.0, scatter(3, 3) - normalizedSquare(known, with_light)) / (pixels - 4);
  }
};

/// What is summed over the pixels of a patch.
struct Sums {
  int pixels = 0;
  double z_m = 0, z_squared = 0, range_m = 0, radius_squared = 0;
  std::array<ColourSums, 3> colours;
  Surroundings<double> around = Surroundings<double>::Zero();

  /// `measured`: the colour that this pixel tells of, as colourAt(); what is between says nothing of its own.
  void add(const Vector2d& where, int measured, const cv::Vec3f& light, const cv::Vec3f& surface, double z,
           double range) {
    ++pixels;
    z_m += z;
    z_squared += z * z;
    range_m += range;
    radius_squared += range * range / (z * z) - 1;
    for (int c = 0; c < 3; ++c)
      if (measured < 0 || measured == c)
        colours[static_cast<std::size_t>(c)].add(where, surface[c], light[c]);
  }
  void addAround(std::size_t blur, const cv::Vec3f& surface) {
    around.col(static_cast<Eigen::Index>(blur)) += Vector3d(surface[0], surface[1], surface[2]);
  }
};

/// Four pixels with the patch's mean and covariance: what varies smoothly over it has their mean.
std::array<Vector2d, 4> pixelsAround(const Patch& patch) {
  const SymmetricEigen spread = eigenOf(patch.pixel_covariance);
  const Eigen::Matrix2d steps =
      std::numbers::sqrt2 * spread.vectors * spread.values.cwiseMax(0).cwiseSqrt().asDiagonal();
  return {patch.pixel + steps.col(0), patch.pixel - steps.col(0), patch.pixel + steps.col(1),
          patch.pixel - steps.col(1)};
}

/// What a colour's pixels say of it. They vary by the sensor's noise, or by more where there is texture or
/// something misplaced. Of a linear camera the mean is freed from what rounding does to it.
struct Measured {
  double radiance = 0, sigma = 0;
};
Measured measured(double mean, double seen, double n, const CameraSheet& sheet) {
  const double step = radianceStep(mean, sheet), noise = radianceSigma(mean, sheet);
  if (sheet.response_gamma == 1) {
    const BeforeRounding before = beforeRounding(mean / step, seen / (step * step), n, noise / step);
    return {step * before.mean, step * before.sigma};
  }
  return {mean, std::sqrt(std::max(seen, noise * noise + step * step / 12) / n)};
}

Patch patchFrom(const Sums& sums, const CameraSheet& sheet, PatchSet& set) {
  const double n = sums.pixels;
  Patch patch;
  patch.pixels = sums.pixels;
  const double mean_m = sums.z_m / n;
  patch.z_m = mean_m - 0.5 * kUsualAttenuation_per_m * (sums.z_squared / n - mean_m * mean_m);
  patch.range_m = sums.range_m / n;
  const ColourSums& places = sums.colours[1];  // green is the densest
  patch.pixel = places.sum.head<2>() / places.pixels;
  patch.pixel_covariance =
      places.products.topLeftCorner<2, 2>() / places.pixels - patch.pixel * patch.pixel.transpose();
  patch.image_radius = std::sqrt(std::max(0.0, sums.radius_squared / n));
  for (const Vector2d& pixel : pixelsAround(patch)) patch.image_tangent += 0.25 * sheet.model.idealAt(pixel);
  patch.response_gamma = sheet.response_gamma;
  patch.albedo_around = sums.around / n;
  const double full = radianceOf((1 << sheet.bits) - 1, sheet);
  bool saturated = false, dark = false;
  for (int c = 0; c < 3; ++c) {
    const ColourSums& own = sums.colours[static_cast<std::size_t>(c)];
    if (own.pixels < kFewestOfAColour) continue;
    patch.albedo[c] = own.sum[2] / own.pixels;
    const double mean = patch.radiance[c] = own.sum[3] / own.pixels;
    const bool too_bright = own.brightest >= full;
    const bool too_dark = mean < kDarkSigmas * radianceSigma(mean, sheet);
    saturated |= too_bright;
    dark |= too_dark;
    if (too_bright || too_dark) continue;
    const Measured colour = measured(mean, own.variance(), own.pixels, sheet);
    patch.radiance[c] = colour.radiance;
    patch.sigma[c] = colour.sigma;
  }
  set.saturated += saturated ? 1 : 0;
  set.dark += dark ? 1 : 0;
  return patch;
}

/// Of the patches' albedo and reading, mean over the channels; 1 where all patches have one albedo.
double correlation(const std::vector<Patch>& patches) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (const Patch& patch : patches) {
    const double a = patch.albedo.sum(), r = patch.radiance.sum();
    n += 1, x += a, y += r, xx += a * a, xy += a * r, yy += r * r;
  }
  const double var_x = n * xx - x * x, var_y = n * yy - y * y;
  return var_x < 1e-4 * n * n || var_y <= 0 ? 1 : (n * xy - x * y) / std::sqrt(var_x * var_y);
}

std::string whyUnusable(const PatchSet& set) {
  const std::size_t count = set.patches.size();
  if (count < kFewestOfAnImage)
    return "no part of a panel that is large enough is in view of its pose (" + std::to_string(count) +
           " patches)";
  if (static_cast<double>(set.saturated) > kSaturatedShare * static_cast<double>(count))
    return print("is overexposed: %.0f %% of the panel is at full scale",
                 100.0 * static_cast<double>(set.saturated) / static_cast<double>(count));
  if (const double r = correlation(set.patches); r < kLeastCorrelation)
    return print(
        "does not show the panel where its pose puts it: bright and dark parts correlate by %.2f only", r);
  return "";
}

}  // namespace

cv::Mat flatInterior(const View& clean, const cv::Mat& mask, const PatchOptions& options) {
  const cv::Mat window = cv::Mat::ones(2 * options.margin_px + 1, 2 * options.margin_px + 1, CV_8UC1);
  cv::Mat brightest, darkest, flat, inside;
  cv::dilate(clean.radiance, brightest, window);
  cv::erode(clean.radiance, darkest, window);
  cv::subtract(brightest, darkest, darkest);
  cv::inRange(darkest, cv::Scalar::all(0), cv::Scalar::all(options.flatness), flat);
  cv::erode(mask, inside, window, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return flat & inside & (clean.range_m < std::numeric_limits<float>::infinity());
}

cv::Mat knownAround(const View& clean, const CameraModel& camera) {
  constexpr double kKnown = 0.99;
  constexpr int kKnownBends = 2;
  cv::Mat hit;
  cv::Mat(clean.range_m < std::numeric_limits<float>::infinity()).convertTo(hit, CV_32F, 1.0 / 255);
  return cv::Mat(bentLight(hit, camera, kKnownBends) > kKnown) & cv::Mat(hit > 0);
}

std::array<Vector3d, 4> placesAround(const Patch& patch, const CameraModel& camera,
                                     const Pose& T_panel_camera) {
  const Vector3d eye = T_panel_camera.position;
  const Vector3d middle = T_panel_camera * Vector3d(patch.z_m * camera.idealAt(patch.pixel).homogeneous());
  std::array<Vector3d, 4> points;
  const std::array<Vector2d, 4> pixels = pixelsAround(patch);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d ray = T_panel_camera.rotation * camera.rayAt(pixels[i]);
    points[i] = eye + (middle.z() - eye.z()) / ray.z() * ray;
  }
  return points;
}

Eigen::Vector2d middleOnPanel_m(const std::array<Vector3d, 4>& around_panel) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& point : around_panel) sum += point;
  return 0.25 * sum.head<2>();
}

cv::Mat squareLabels(const cv::Size& size, int side_px) {
  const int across = (size.width + side_px - 1) / side_px;
  cv::Mat labels(size, CV_32SC1);
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u) labels.at<int>(v, u) = v / side_px * across + u / side_px;
  return labels;
}

PatchSet patchesOf(const cv::Mat& image, const View& clean, const cv::Mat& mask, const cv::Mat& z_per_range,
                   const cv::Mat& labels, const CameraSheet& sheet, const PatchOptions& options) {
  PatchSet set;
  if (image.size() != clean.radiance.size()) {
    set.why_not = print("is of %d x %d pixels, its rendering of %d x %d", image.cols, image.rows,
                        clean.radiance.cols, clean.radiance.rows);
    return set;
  }
  cv::Mat usable = flatInterior(clean, mask, options);
  usable &= labels >= 0;
  // Images of numbers are large: row by row, and one blur at a time.
  std::map<int, Sums> by_label;
  cv::Scalar all;
  for (int v = 0; v < image.rows; ++v) {
    const cv::Mat light = radianceOf(image.row(v), sheet);
    all += cv::sum(light);
    for (int u = 0; u < image.cols; ++u) {
      if (usable.at<std::uint8_t>(v, u) == 0) continue;
      const double range = clean.range_m.at<float>(v, u);
      by_label[labels.at<int>(v, u)].add(Vector2d(u, v), colourAt(sheet.model.bayer, u, v),
                                         light.at<cv::Vec3f>(u), clean.radiance.at<cv::Vec3f>(v, u),
                                         range * z_per_range.at<float>(v, u), range);
    }
  }
  for (std::size_t i = 0; options.around && i < kBends.size(); ++i) {
    const cv::Mat soft = bentLight(clean.radiance, sheet.model, kBends[i]);
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u)
        if (usable.at<std::uint8_t>(v, u) != 0)
          by_label[labels.at<int>(v, u)].addAround(i, soft.at<cv::Vec3f>(v, u));
  }
  const cv::Scalar mean = all / static_cast<double>(image.total());
  for (const auto& [label, sums] : by_label)
    if (sums.pixels >= options.least_pixels) {
      set.patches.push_back(patchFrom(sums, sheet, set));
      set.patches.back().label = label;
      set.patches.back().image_mean = {mean[0], mean[1], mean[2]};
    }
  set.why_not = whyUnusable(set);
  return set;
}

}  // namespace fathom
