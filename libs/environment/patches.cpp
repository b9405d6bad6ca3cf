#include "environment/patches.h"

#include <opencv2/imgproc.hpp>

#include "core/text.h"
#include "sensors/image_model.h"

namespace fathom {
namespace {

constexpr double kLeastCorrelation = 0.5;     // of albedo and reading within an image
constexpr double kSaturatedShare = 0.5;       // of patches, from which on the image counts as overexposed
constexpr double kDarkSigmas = 3;             // a mean nearer to 0 is biased by clipping there
constexpr std::size_t kFewestOfAnImage = 10;  // of an image

/// Not 0 where all within the margin is one trusted surface of one albedo.
cv::Mat interior(const View& clean, const cv::Mat& mask, const PatchOptions& options) {
  const cv::Mat window = cv::Mat::ones(2 * options.margin_px + 1, 2 * options.margin_px + 1, CV_8UC1);
  cv::Mat brightest, darkest, flat, inside;
  cv::dilate(clean.radiance, brightest, window);
  cv::erode(clean.radiance, darkest, window);
  cv::inRange(brightest - darkest, cv::Scalar::all(0), cv::Scalar::all(options.flatness), flat);
  cv::erode(mask, inside, window, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return flat & inside & (clean.range_m < std::numeric_limits<float>::infinity());
}

/// What is summed over the pixels of a patch.
struct Sums {
  int pixels = 0;
  double z_m = 0, range_m = 0;
  Vector3d albedo = Vector3d::Zero(), radiance = Vector3d::Zero(), squares = Vector3d::Zero();
  Vector3d largest = Vector3d::Zero();

  void add(const cv::Vec3f& light, const cv::Vec3f& surface, double z, double range) {
    ++pixels;
    z_m += z;
    range_m += range;
    for (int c = 0; c < 3; ++c) {
      const double value = light[c];
      albedo[c] += surface[c];
      radiance[c] += value;
      squares[c] += value * value;
      largest[c] = std::max(largest[c], value);
    }
  }
};

/// Width of one digital number, in radiance, there.
double quantum(double radiance, const CameraSheet& sheet) {
  const int top = (1 << sheet.bits) - 1;
  const int number = static_cast<int>(std::pow(std::clamp(radiance, 0.0, 1.0), sheet.response_gamma) * top);
  const int below = std::min(number, top - 1);
  return radianceOf(below + 1, sheet) - radianceOf(below, sheet);
}

/// Pixels of a patch vary by the sensor's noise, or by more where there is texture or something misplaced.
double sigmaOfMean(double mean, double mean_square, int pixels, const CameraSheet& sheet) {
  const double n = pixels, rounding = quantum(mean, sheet) * quantum(mean, sheet) / 12;
  const double seen = n / (n - 1) * std::max(0.0, mean_square - mean * mean);
  const double expected = std::pow(radianceSigma(mean, sheet), 2) + rounding;
  return std::sqrt(std::max(seen, expected) / n);
}

Patch patchFrom(const Sums& sums, const CameraSheet& sheet, PatchSet& set) {
  const double n = sums.pixels;
  Patch patch{0, sums.z_m / n, sums.range_m / n, sums.albedo / n, sums.radiance / n, Patch().sigma};
  const double full = radianceOf((1 << sheet.bits) - 1, sheet);
  bool saturated = false, dark = false;
  for (int c = 0; c < 3; ++c) {
    const double mean = patch.radiance[c];
    const bool too_bright = sums.largest[c] >= full;
    const bool too_dark = mean < kDarkSigmas * radianceSigma(mean, sheet);
    saturated |= too_bright;
    dark |= too_dark;
    if (!too_bright && !too_dark) patch.sigma[c] = sigmaOfMean(mean, sums.squares[c] / n, sums.pixels, sheet);
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

PatchSet patchesOf(const cv::Mat& image, const View& clean, const cv::Mat& mask, const cv::Mat& z_per_range,
                   const CameraSheet& sheet, const PatchOptions& options) {
  PatchSet set;
  if (image.size() != clean.radiance.size()) {
    set.why_not = print("is of %d x %d pixels, its rendering of %d x %d", image.cols, image.rows,
                        clean.radiance.cols, clean.radiance.rows);
    return set;
  }
  const cv::Mat light = radianceOf(image, sheet), usable = interior(clean, mask, options);
  for (int top = 0; top < image.rows; top += options.side_px)
    for (int left = 0; left < image.cols; left += options.side_px) {
      const cv::Rect block =
          cv::Rect(left, top, options.side_px, options.side_px) & cv::Rect({}, image.size());
      Sums sums;
      for (int v = block.y; v < block.br().y; ++v)
        for (int u = block.x; u < block.br().x; ++u)
          if (usable.at<std::uint8_t>(v, u) != 0) {
            const double range = clean.range_m.at<float>(v, u);
            sums.add(light.at<cv::Vec3f>(v, u), clean.radiance.at<cv::Vec3f>(v, u),
                     range * z_per_range.at<float>(v, u), range);
          }
      if (sums.pixels >= options.least_pixels) set.patches.push_back(patchFrom(sums, sheet, set));
    }
  set.why_not = whyUnusable(set);
  return set;
}

}  // namespace fathom
