#include "similarity/fsim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "imaging/eight_bits.h"
#include "similarity/phase_congruency.h"

namespace fathom {
namespace {

static_assert(FsimComparer::kLeastSide_px >= PhaseCongruency::kLongestWave_px);

// The paper's T1 to T4 and lambda.
constexpr float kCongruencyFloor = 0.85F, kGradientFloor = 160, kColourFloor = 200, kColourWeight = 0.03F;
constexpr double kWorkingSide_px = 256;
constexpr std::size_t kMostSizes = 8;  // whose filters are kept: 32 bytes a pixel, reduced

struct Yiq {
  cv::Mat y, i, q;  // CV_32FC1, digital numbers
};

int reductionOf(const cv::Size& size) {
  return std::max(1, static_cast<int>(std::lround(std::min(size.width, size.height) / kWorkingSide_px)));
}

/// Where MATLAB's conv2(…, 'same') with an average of `factor` puts the window of output `index`: before
/// the image's edge it averages with zeros.
std::pair<int, int> window(int index, int factor, int count) {
  const int end = index * factor + factor / 2 + 1;
  return {std::max(0, end - factor), std::min(count, end)};
}

/// Averages of factor x factor pixels, a channel at a time, times factor². Sums of 8-bit numbers: exact.
void addColumns(const cv::Mat& bgr, const std::pair<int, int>& rows, std::vector<std::int32_t>& sums) {
  std::fill(sums.begin(), sums.end(), 0);
  for (int v = rows.first; v < rows.second; ++v) {
    const auto* row = bgr.ptr<std::uint8_t>(v);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += row[i];
  }
}

Yiq reducedYiq(const cv::Mat& bgr) {
  const int factor = reductionOf(bgr.size());
  const auto share = 1.0F / static_cast<float>(factor * factor);
  const cv::Size size((bgr.cols + factor - 1) / factor, (bgr.rows + factor - 1) / factor);
  Yiq result{cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1)};
  std::vector<std::int32_t> sums(3 * static_cast<std::size_t>(bgr.cols));
  for (int v = 0; v < size.height; ++v) {
    addColumns(bgr, window(v, factor, bgr.rows), sums);
    auto *y = result.y.ptr<float>(v), *i = result.i.ptr<float>(v), *q = result.q.ptr<float>(v);
    for (int u = 0; u < size.width; ++u) {
      const auto [begin, end] = window(u, factor, bgr.cols);
      std::array<std::int32_t, 3> sum{};
      for (auto at = 3 * static_cast<std::size_t>(begin); at < 3 * static_cast<std::size_t>(end); at += 3)
        for (std::size_t c = 0; c < 3; ++c) sum[c] += sums[at + c];
      const float blue = share * static_cast<float>(sum[0]), green = share * static_cast<float>(sum[1]),
                  red = share * static_cast<float>(sum[2]);
      y[u] = 0.299F * red + 0.587F * green + 0.114F * blue;
      i[u] = 0.596F * red - 0.274F * green - 0.322F * blue;
      q[u] = 0.211F * red - 0.523F * green + 0.312F * blue;
    }
  }
  return result;
}

cv::Mat gradientMagnitude(const cv::Mat& luminance) {
  cv::Mat along_x, along_y, magnitude;
  cv::Scharr(luminance, along_x, CV_32F, 1, 0, 1.0 / 16, 0, cv::BORDER_CONSTANT);
  cv::Scharr(luminance, along_y, CV_32F, 0, 1, 1.0 / 16, 0, cv::BORDER_CONSTANT);
  cv::magnitude(along_x, along_y, magnitude);
  return magnitude;
}

/// (2ab + floor) / (a² + b² + floor), so written that it is 1 exactly where a is b.
inline float similarity(float a, float b, float floor) {
  return 1.0F - (a - b) * (a - b) / (a * a + b * b + floor);
}

/// Colours may be opposite; as in the authors' values it is the real part of the power that counts.
inline float realPower(float base) {
  static const auto opposite = static_cast<float>(std::cos(std::numbers::pi * kColourWeight));
  return base >= 0.0F ? std::pow(base, kColourWeight) : opposite * std::pow(-base, kColourWeight);
}

std::string sizeText(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows);
}

}  // namespace

FsimComparer::FsimComparer() = default;
FsimComparer::~FsimComparer() = default;

std::optional<std::string> FsimComparer::whyNot(const cv::Mat& image) {
  if (image.empty()) return "the image is empty";
  const bool has_depth = image.depth() == CV_8U || image.depth() == CV_16U;
  if (!has_depth || (image.channels() != 3 && image.channels() != 1))
    return "the image is not of 8 bits, or 16, and of three channels or one";
  if (std::min(image.cols, image.rows) < kLeastSide_px)
    return "the image is of " + sizeText(image) + " pixels; FSIM's filters need " +
           std::to_string(kLeastSide_px) + " or more either way";
  return std::nullopt;
}

std::optional<std::string> FsimComparer::whyNot(const cv::Mat& reference, const cv::Mat& image) {
  for (const auto& one : {reference, image})
    if (auto why = whyNot(one)) return why;
  if (reference.size() != image.size())
    return "the image is of " + sizeText(image) + " pixels, the reference of " + sizeText(reference);
  return std::nullopt;
}

FsimFeatures FsimComparer::features(const cv::Mat& image) const {
  if (const auto why = whyNot(image)) throw std::invalid_argument("FSIM: " + *why);
  cv::Mat bgr = inEightBits(image);
  if (bgr.channels() == 1) cv::cvtColor(bgr, bgr, cv::COLOR_GRAY2BGR);
  const Yiq yiq = reducedYiq(bgr);
  return {image.size(), congruencyFor(yiq.y.size())->of(yiq.y), gradientMagnitude(yiq.y), yiq.i, yiq.q};
}

std::optional<FsimScore> FsimComparer::compare(const FsimFeatures& reference, const FsimFeatures& image) {
  if (reference.image_size != image.image_size) throw std::invalid_argument("FSIM: images of two sizes");
  double weights = 0, alike = 0, alike_in_colour = 0;
  for (int v = 0; v < reference.phase_congruency.rows; ++v) {
    const auto row = [v](const cv::Mat& map) { return map.ptr<float>(v); };
    const auto *congruency_a = row(reference.phase_congruency), *congruency_b = row(image.phase_congruency);
    const auto *gradient_a = row(reference.gradient_magnitude), *gradient_b = row(image.gradient_magnitude);
    const auto *i_a = row(reference.in_phase), *i_b = row(image.in_phase);
    const auto *q_a = row(reference.quadrature), *q_b = row(image.quadrature);
    for (int u = 0; u < reference.phase_congruency.cols; ++u) {
      const float weight = std::max(congruency_a[u], congruency_b[u]);
      const float structure = weight * similarity(congruency_a[u], congruency_b[u], kCongruencyFloor) *
                              similarity(gradient_a[u], gradient_b[u], kGradientFloor);
      const float colour =
          similarity(i_a[u], i_b[u], kColourFloor) * similarity(q_a[u], q_b[u], kColourFloor);
      weights += weight;
      alike += structure;
      alike_in_colour += structure * realPower(colour);
    }
  }
  if (weights == 0) return std::nullopt;
  return FsimScore{alike / weights, alike_in_colour / weights};
}

std::optional<FsimScore> FsimComparer::compare(const cv::Mat& reference, const cv::Mat& image) const {
  if (reference.depth() == CV_16U && image.depth() == CV_16U) {
    const LevelRange both = joined(usedRange(reference), usedRange(image));
    return compare(features(inEightBits(reference, both)), features(inEightBits(image, both)));
  }
  return compare(features(reference), features(image));
}

std::shared_ptr<const PhaseCongruency> FsimComparer::congruencyFor(const cv::Size& size) const {
  const std::lock_guard lock(mutex_);
  const std::pair key(size.width, size.height);
  if (const auto found = congruencies_.find(key); found != congruencies_.end()) return found->second;
  if (congruencies_.size() == kMostSizes) congruencies_.clear();
  return congruencies_[key] = std::make_shared<const PhaseCongruency>(size);
}

}  // namespace fathom
