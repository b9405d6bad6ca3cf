#include "imaging/image_model.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "core/parallel.h"

namespace fathom {
namespace {

/// exp(-depth) for depth >= 0 or NaN, to 2e-7 relative: 2^n times 2^f, with f in [-0.5, 0.5] by its Taylor
/// series to the sixth power. Infinite and NaN give e^-87, which is nothing. No branches, so that loops over
/// it are vectorized.
inline float transmission(float depth) {
  const float power = (depth < 87.0F ? depth : 87.0F) * -1.44269504F;
  const auto whole = static_cast<std::int32_t>(power - 0.5F);
  const float x = (power - static_cast<float>(whole)) * 0.693147181F;
  const float series =
      1.0F + x * (1.0F + x * (0.5F + x * (1.0F / 6 + x * (1.0F / 24 + x * (1.0F / 120 + x * (1.0F / 720))))));
  return std::bit_cast<float>((whole + 127) << 23) * series;
}

double normalCumulative(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// Normal numbers four a draw: a table of the inverse cumulative distribution at 65536 equally likely places,
/// scaled to unit variance. Ten times as fast as Box-Muller, and an image has a million.
class NormalTable {
 public:
  static constexpr std::size_t kSize = 65536;

  static const NormalTable& instance() {
    static const NormalTable table;
    return table;
  }

  void fill(std::vector<float>& numbers, Random& random) const {
    for (std::size_t i = 0; i < numbers.size(); i += 4) {
      std::uint64_t bits = random.bits();
      for (std::size_t j = i; j < std::min(i + 4, numbers.size()); ++j, bits >>= 16)
        numbers[j] = values_[bits & 0xffffU];
    }
  }

 private:
  NormalTable() : values_(kSize) {
    std::vector<double> lower(kSize / 2);
    double x = 0, squares = 0;
    for (std::size_t i = kSize / 2; i-- > 0;) {
      // From the middle outwards: the last root lies to the right of the next, where the cumulative
      // distribution is convex, so that Newton's method comes down to it.
      const double p = (static_cast<double>(i) + 0.5) / kSize;
      for (int round = 0; round < 12; ++round)
        x -= (normalCumulative(x) - p) / (std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi));
      lower[i] = x;
      squares += 2 * x * x;
    }
    const double scale = 1 / std::sqrt(squares / kSize);
    for (std::size_t i = 0; i < kSize / 2; ++i) {
      values_[i] = static_cast<float>(scale * lower[i]);
      values_[kSize - 1 - i] = -values_[i];
    }
  }

  std::vector<float> values_;
};

double fullScale(const CameraSheet& sheet) { return static_cast<double>((1 << sheet.bits) - 1); }

void require(const cv::Mat& image, int type, const cv::Size& size) {
  if (image.type() != type || image.size() != size)
    throw std::invalid_argument("an image of the camera's size and of another type is needed");
}

/// A row of radiances, red green blue, to numbers, blue green red.
template <class Number>
void writeNumbers(const float* readings, std::size_t count, float full_scale, Number* bgr) {
  for (std::size_t i = 0; i < count; i += 3)
    for (std::size_t c = 0; c < 3; ++c)
      bgr[i + 2 - c] = static_cast<Number>(cvRound(readings[i + c] * full_scale));
}

}  // namespace

double radianceStep(double radiance, const CameraSheet& sheet) {
  const double light = std::clamp(radiance, 1e-3, 1.0), gamma = sheet.response_gamma;
  return std::pow(light, 1 - gamma) / (gamma * fullScale(sheet));
}

double pixelSigma(double radiance, const CameraSheet& sheet) {
  return std::hypot(radianceSigma(radiance, sheet), radianceStep(radiance, sheet) / std::sqrt(12));
}

double radianceOf(int number, const CameraSheet& sheet) {
  return std::pow(number / fullScale(sheet), 1 / sheet.response_gamma);
}

cv::Mat radianceOf(const cv::Mat& image_bgr, const CameraSheet& sheet) {
  require(image_bgr, sheet.bits > 8 ? CV_16UC3 : CV_8UC3, image_bgr.size());
  // As many as the type can hold, so that no number in a file lies beyond the table.
  std::vector<float> table(sheet.bits > 8 ? 65536 : 256);
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i] = static_cast<float>(radianceOf(static_cast<int>(i), sheet));
  cv::Mat result(image_bgr.size(), CV_32FC3);
  const auto convert = [&]<class Number>(Number) {
    for (int v = 0; v < result.rows; ++v) {
      const auto* from = image_bgr.ptr<Number>(v);
      auto* to = result.ptr<float>(v);
      for (int i = 0; i < 3 * result.cols; i += 3)
        for (int c = 0; c < 3; ++c) to[i + c] = table[from[i + 2 - c]];
    }
  };
  sheet.bits > 8 ? convert(std::uint16_t{}) : convert(std::uint8_t{});
  return result;
}

cv::Mat raysOf(const CameraModel& camera) {
  cv::Mat rays(camera.height_px, camera.width_px, CV_32FC3);
  parallelFor(rays.rows, [&](int v) {
    for (int u = 0; u < rays.cols; ++u) {
      const Vector3d ray = camera.rayAt({u, v});
      rays.at<cv::Vec3f>(v, u) = cv::Vec3d(ray[0], ray[1], ray[2]);
    }
  });
  return rays;
}

cv::Mat cosinesOf(const CameraModel& camera) {
  cv::Mat cosines;
  cv::extractChannel(raysOf(camera), cosines, 2);
  return cosines;
}

namespace {

/// One step of level lines that move by so many pixels, at most half of one: u_t = |grad u| by differences
/// to the brighter side only (to the darker one where black grows), which move a step along an axis by
/// exactly that, in area, and overshoot nowhere (Osher & Sethian 1988, Rouy & Tourin 1992).
cv::Mat grownALittle(const cv::Mat& light, float by_px) {
  const float sign = by_px < 0 ? -1.0F : 1.0F;
  cv::Mat grown(light.size(), CV_32FC3);
  parallelFor(light.rows, [&](int v) {
    for (int u = 0; u < light.cols; ++u) {
      const auto& here = light.at<cv::Vec3f>(v, u);
      const auto& left = light.at<cv::Vec3f>(v, std::max(u - 1, 0));
      const auto& right = light.at<cv::Vec3f>(v, std::min(u + 1, light.cols - 1));
      const auto& over = light.at<cv::Vec3f>(std::max(v - 1, 0), u);
      const auto& under = light.at<cv::Vec3f>(std::min(v + 1, light.rows - 1), u);
      for (int c = 0; c < 3; ++c) {
        const float across = std::max({0.0F, sign * (left[c] - here[c]), sign * (right[c] - here[c])}),
                    upright = std::max({0.0F, sign * (over[c] - here[c]), sign * (under[c] - here[c])});
        grown.at<cv::Vec3f>(v, u)[c] = here[c] + by_px * std::sqrt(across * across + upright * upright);
      }
    }
  });
  return grown;
}

}  // namespace

cv::Mat whiteGrown(const cv::Mat& light, double by_px) {
  constexpr double kStep_px = 0.5;
  require(light, CV_32FC3, light.size());
  const int steps = static_cast<int>(std::ceil(std::abs(by_px) / kStep_px));
  cv::Mat grown = light;
  for (int step = 0; step < steps; ++step) grown = grownALittle(grown, static_cast<float>(by_px / steps));
  return grown;
}

cv::Mat withStrayLight(const cv::Mat& light, double share) {
  require(light, CV_32FC3, light.size());
  if (share == 0) return light;
  cv::Mat mixed;
  light.convertTo(mixed, CV_32F, 1 - share);
  return mixed + share * cv::mean(light);
}

cv::Mat covered(const cv::Mat& light, const EffectParameters<double>& effects, double t_s) {
  require(light, CV_32FC3, light.size());
  if (!anyActsAt<ViewCover<double>>(effects)) return light;
  cv::Mat seen(light.size(), CV_32FC3);
  parallelFor(light.rows, [&](int v) {
    for (int u = 0; u < light.cols; ++u) {
      ViewCover<double> cover{{(u + 0.5) / light.cols, (v + 0.5) / light.rows}, {0, 0}};
      applyEffects(effects, t_s, cover);
      const auto share = static_cast<float>(cover.share), radiance = static_cast<float>(cover.radiance);
      seen.at<cv::Vec3f>(v, u) = (1 - share) * light.at<cv::Vec3f>(v, u) + cv::Vec3f::all(share * radiance);
    }
  });
  return seen;
}

cv::Mat defocused(const cv::Mat& light, double variance_px2) {
  if (variance_px2 <= 0) return light;
  cv::Mat soft;
  cv::GaussianBlur(light, soft, {}, std::sqrt(variance_px2), 0, cv::BORDER_REPLICATE);
  return soft;
}

cv::Mat interpolatedColours(const cv::Mat& readings, double share) {
  require(readings, CV_32FC3, readings.size());
  const cv::Matx33f cross(0, 0.25F, 0, 0.25F, 1, 0.25F, 0, 0.25F, 0),
      square(0.25F, 0.5F, 0.25F, 0.5F, 1, 0.5F, 0.25F, 0.5F, 0.25F);
  cv::Mat mixed = readings.clone();
  for (int c = 0; c < 3; ++c) {
    cv::Mat measured, full;
    cv::extractChannel(readings, measured, c);
    for (int v = 0; v < measured.rows; ++v)
      for (int u = 0; u < measured.cols; ++u) {
        const int odd = v % 2 + u % 2;  // 0 red, 1 green, 2 blue
        if (odd != c) measured.at<float>(v, u) = 0;
      }
    // Mirrored about its outermost pixel, the pattern goes on.
    cv::filter2D(measured, full, CV_32F, c == 1 ? cross : square, {-1, -1}, 0, cv::BORDER_REFLECT_101);
    cv::extractChannel(readings, measured, c);
    cv::addWeighted(measured, 1 - share, full, share, 0, full);
    cv::insertChannel(full, mixed, c);
  }
  return mixed;
}

cv::Mat sharpened(const cv::Mat& readings, double amount) {
  cv::Mat soft, sharp;
  cv::GaussianBlur(readings, soft, {}, Sharpening::kRadius_px, 0, cv::BORDER_REPLICATE);
  cv::addWeighted(readings, 1 + amount, soft, -amount, 0, sharp);
  return cv::min(cv::max(sharp, 0.0), 1.0);
}

ImageModel::ImageModel(const CameraSheet& sheet, const Water& water, const EffectParameters<double>& effects)
    : sheet_(sheet), water_(water), effects_(effects), rays_(raysOf(sheet.model)) {}

void ImageModel::throughWater(cv::Mat& light, const cv::Mat& range_m, double t_s) const {
  require(light, CV_32FC3, rays_.size());
  require(range_m, CV_32FC1, rays_.size());
  if (anyActsAt<WaterRay<double>>(effects_)) return throughWaterWithEffects(light, range_m, t_s);
  const std::array<float, 3> a{static_cast<float>(water_.attenuation_per_m[0]),
                               static_cast<float>(water_.attenuation_per_m[1]),
                               static_cast<float>(water_.attenuation_per_m[2])};
  const auto row_size = 3 * static_cast<std::size_t>(light.cols);
  std::vector<float> veil(row_size);
  for (std::size_t i = 0; i < row_size; ++i)
    veil[i] = static_cast<float>(water_.veil[static_cast<int>(i % 3)]);
  parallelFor(light.rows, [&](int v) {
    std::vector<float> passed(row_size);
    const auto *range = range_m.ptr<float>(v), *ray = rays_.ptr<float>(v);
    auto* here = light.ptr<float>(v);
    for (std::size_t u = 0; 3 * u < row_size; ++u) {
      const float z_m = range[u] * ray[3 * u + 2];
      for (std::size_t c = 0; c < 3; ++c) passed[3 * u + c] = a[c] * z_m;
    }
    for (std::size_t i = 0; i < row_size; ++i) passed[i] = transmission(passed[i]);
    for (std::size_t i = 0; i < row_size; ++i) here[i] = veil[i] + (here[i] - veil[i]) * passed[i];
  });
}

void ImageModel::throughWaterWithEffects(cv::Mat& light, const cv::Mat& range_m, double t_s) const {
  const bool bends = effects_.isActive(kEffectIndex<ForwardScatter>, t_s);
  std::array<cv::Mat, kBends.size()> soft;
  for (std::size_t i = 0; i < kBends.size(); ++i)
    soft[i] = bends ? bentLight(light, sheet_.model, kBends[i]) : light;
  const auto at = [](const cv::Mat& image, int v, int u) {
    const auto& colour = image.at<cv::Vec3f>(v, u);
    return Vector3d(colour[0], colour[1], colour[2]);
  };
  parallelFor(light.rows, [&](int v) {
    for (int u = 0; u < light.cols; ++u) {
      SceneRadiance<double> scene(at(light, v, u));
      for (std::size_t i = 0; i < kBends.size(); ++i)
        scene.around.col(static_cast<Eigen::Index>(i)) = at(soft[i], v, u);
      const double range = range_m.at<float>(v, u);
      const Vector3d ray = at(rays_, v, u);
      SightInScene<double> sight;
      if (T_scene_camera_) sight = {T_scene_camera_->position, T_scene_camera_->rotation * ray.normalized()};
      const Vector3d seen = predictLight<double>(scene, range * ray.z(), range, water_, effects_, t_s, sight);
      light.at<cv::Vec3f>(v, u) = cv::Vec3d(seen[0], seen[1], seen[2]);
    }
  });
}

/// Of each number in a row.
struct ImageModel::RowResponse {
  std::vector<float> gain, offset;
};

void ImageModel::respondAlong(int row, double t_s, RowResponse& along) const {
  for (int u = 0; u < rays_.cols; ++u) {
    const auto& ray = rays_.at<cv::Vec3f>(row, u);
    const Vector2d tangent(ray[0] / ray[2], ray[1] / ray[2]);
    PixelResponse<double> response{tangent.norm(), tangent};
    applyEffects(effects_, t_s, response);
    for (int c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(3 * u + c);
      along.gain[i] = static_cast<float>(response.gain[c]);
      along.offset[i] = static_cast<float>(response.offset[c]);
    }
  }
}

cv::Mat ImageModel::expose(const cv::Mat& scene_light, Random* noise, double t_s) const {
  require(scene_light, CV_32FC3, rays_.size());
  EdgeSpread<double> edges;
  applyEffects(effects_, t_s, edges);
  StrayLight<double> stray;
  applyEffects(effects_, t_s, stray);
  ImageSoftness<double> softness;
  applyEffects(effects_, t_s, softness);
  const cv::Mat light = withStrayLight(
      defocused(whiteGrown(covered(scene_light, effects_, t_s), edges.white_px), softness.lens_px2),
      stray.share);
  const double amount = softness.sharpened_px2 / (Sharpening::kRadius_px * Sharpening::kRadius_px);
  const auto row_size = 3 * static_cast<std::size_t>(light.cols);
  const auto shot_variance = static_cast<float>(1 / sheet_.full_well_e),
             read_variance = static_cast<float>(std::pow(sheet_.read_noise_e / sheet_.full_well_e, 2)),
             full_scale = static_cast<float>(fullScale(sheet_));
  cv::Mat result(light.size(), sheet_.bits > 8 ? CV_16UC3 : CV_8UC3);
  const bool pixels_differ = anyActsAt<PixelResponse<double>>(effects_);
  ResponseCurve<double> given{sheet_.response_gamma};
  applyEffects(effects_, t_s, given);
  const ResponseCurve<float> curve{static_cast<float>(given.exponent), given.bend.cast<float>()};
  const bool is_curved = curve.exponent != 1.0F || !curve.bend.isZero(0);
  const auto writeRow = [&](int v, const float* reading) {
    if (sheet_.bits > 8)
      writeNumbers(reading, row_size, full_scale, result.ptr<std::uint16_t>(v));
    else
      writeNumbers(reading, row_size, full_scale, result.ptr<std::uint8_t>(v));
  };
  const bool is_processed = amount > 0 || softness.interpolated > 0;
  cv::Mat readings;  // where colours are still to be interpolated, or they are to be sharpened
  if (is_processed) readings.create(light.size(), CV_32FC3);
  const auto exposeRow = [&](int v, const std::vector<float>& normal) {
    std::vector<float> reading(row_size);
    RowResponse along{std::vector<float>(row_size, 1.0F), std::vector<float>(row_size, 0.0F)};
    if (pixels_differ) respondAlong(v, t_s, along);
    const auto* radiance = light.ptr<float>(v);
    for (std::size_t i = 0; i < row_size; ++i) {
      const float exposed = std::max(0.0F, along.gain[i] * radiance[i]);  // a gain may be below 0 far out
      const float sigma = std::sqrt(exposed * shot_variance + read_variance);
      reading[i] = std::clamp(exposed + sigma * normal[i], 0.0F, 1.0F);
    }
    if (pixels_differ || is_curved)
      for (std::size_t i = 0; i < row_size; ++i)
        reading[i] =
            std::clamp(curved(reading[i], curve, static_cast<int>(i % 3)) + along.offset[i], 0.0F, 1.0F);
    if (is_processed)
      std::copy(reading.begin(), reading.end(), readings.ptr<float>(v));
    else
      writeRow(v, reading.data());
  };
  // Noise is one sequence over all rows: it is drawn first, for some rows, which then are worked on at once.
  constexpr int kRowsAtOnce = 64;
  std::vector<std::vector<float>> normal(kRowsAtOnce, std::vector<float>(row_size, 0.0F));
  for (int first = 0; first < light.rows; first += kRowsAtOnce) {
    const int rows = std::min(kRowsAtOnce, light.rows - first);
    if (noise != nullptr)
      for (int k = 0; k < rows; ++k)
        NormalTable::instance().fill(normal[static_cast<std::size_t>(k)], *noise);
    parallelFor(rows, [&](int k) { exposeRow(first + k, normal[static_cast<std::size_t>(k)]); });
  }
  if (is_processed) {
    if (softness.interpolated > 0) readings = interpolatedColours(readings, softness.interpolated);
    if (amount > 0) readings = sharpened(readings, amount);
    parallelFor(readings.rows, [&](int v) { writeRow(v, readings.ptr<float>(v)); });
  }
  return result;
}

}  // namespace fathom
