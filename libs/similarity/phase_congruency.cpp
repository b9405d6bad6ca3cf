#include "similarity/phase_congruency.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace fathom {
namespace {

constexpr double kSigmaOnFrequency = 0.55;  // of the radial Gaussian, as a ratio of frequencies
constexpr double kSpacingOnSigma = 1.2;     // of orientations, over the angular Gaussian's sigma
constexpr double kNoiseSigmas = 2.0;        // above the mean noise energy
constexpr double kNoiseOverestimate = 1.7;  // empirical: the scales' noise is correlated
constexpr double kLowPassCutoff = 0.45;     // cycles a pixel; a Butterworth filter that
constexpr double kLowPassOrder = 15;        // takes the corners off
constexpr float kLeastEnergy = 1e-4F;       // digital numbers: keeps 0 / 0 out

/// Cycles a pixel of each index of a transform; of an odd count, Kovesi's lie a little too far out.
std::vector<double> frequencies(int count) {
  const int divisor = count % 2 == 1 ? count - 1 : count;
  std::vector<double> result;
  for (int i = 0; i < count; ++i)
    result.push_back(static_cast<double>(i < (count + 1) / 2 ? i : i - count) / divisor);
  return result;
}

double logGabor(double radius, int scale) {
  if (radius == 0) return 0;
  const double wave_px = PhaseCongruency::kShortestWave_px * std::pow(PhaseCongruency::kWaveRatio, scale);
  const double sigmas = std::log(radius * wave_px) / std::log(kSigmaOnFrequency);
  const double low_pass = 1 / (1 + std::pow(radius / kLowPassCutoff, 2 * kLowPassOrder));
  return std::exp(-0.5 * sigmas * sigmas) * low_pass;
}

/// y is down; an orientation is counted from x towards up.
double spread(double x, double y, int orientation) {
  constexpr double spacing = std::numbers::pi / PhaseCongruency::kOrientations;
  const double turned = std::atan2(-y, x) - orientation * spacing;
  const double angle = std::atan2(std::sin(turned), std::cos(turned));
  return std::exp(-0.5 * std::pow(angle * kSpacingOnSigma / spacing, 2));
}

template <class Value>
cv::Mat overFrequencies(const cv::Size& size, Value&& value) {
  const auto xs = frequencies(size.width), ys = frequencies(size.height);
  cv::Mat result(size, CV_64FC1);
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u)
      result.at<double>(v, u) = value(xs[static_cast<std::size_t>(u)], ys[static_cast<std::size_t>(v)]);
  return result;
}

/// The filters' answer to white noise, summed in phase over the scales, over that of the finest scale alone:
/// by Parseval's theorem, so that no filter need be transformed. A response's even part passes only the part
/// of the filter that is equal at opposite frequencies.
double noiseRatio(const cv::Mat& all_scales, const cv::Mat& finest) {
  double even_energy = 0;
  for (int v = 0; v < all_scales.rows; ++v)
    for (int u = 0; u < all_scales.cols; ++u) {
      const int opposite_v = (all_scales.rows - v) % all_scales.rows;
      const int opposite_u = (all_scales.cols - u) % all_scales.cols;
      const double even = 0.5 * (all_scales.at<double>(v, u) + all_scales.at<double>(opposite_v, opposite_u));
      even_energy += even * even;
    }
  return even_energy / finest.dot(finest);
}

bool isFlat(const cv::Mat& image) {
  double least = 0, most = 0;
  cv::minMaxLoc(image, &least, &most);
  return least == most;
}

/// Scaled so that the inverse transform needs no scale. The mean plays no part; without it single precision
/// goes further.
cv::Mat spectrumOf(const cv::Mat& luminance) {
  cv::Mat centred, spectrum;
  luminance.convertTo(centred, CV_32F, 1, -cv::mean(luminance)[0]);
  cv::dft(centred, spectrum, cv::DFT_COMPLEX_OUTPUT);
  return spectrum * (1.0 / static_cast<double>(luminance.total()));
}

/// The mean of the two middle ones of an even count.
float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5F * (*middle + *std::max_element(values.begin(), middle));
}

/// Complex answers of an orientation's filters, fine to coarse: real is even, imaginary odd.
using Responses = std::array<cv::Mat, PhaseCongruency::kScales>;

/// Adds an orientation's energy above the noise, and its amplitudes, to the two channels of `sums` (which are
/// one image because the compiler looks at several pixels at a time only where few images could overlap). The
/// energy is the sum over scales of a response's part along the mean phase, less its part across.
void accumulate(const Responses& responses, float noise, cv::Mat& sums) {
  std::array<const float*, PhaseCongruency::kScales> parts{};
  for (std::size_t s = 0; s < responses.size(); ++s) parts[s] = responses[s].ptr<float>();
  auto* sum = sums.ptr<float>();
  const std::size_t count = sums.total();
  for (std::size_t i = 0; i < count; ++i) {
    float even = 0, odd = 0, across = 0, amplitude = 0;
    for (const float* part : parts) {
      even += part[2 * i];
      odd += part[2 * i + 1];
      amplitude += std::sqrt(part[2 * i] * part[2 * i] + part[2 * i + 1] * part[2 * i + 1]);
    }
    for (const float* part : parts) across += std::abs(part[2 * i] * odd - part[2 * i + 1] * even);
    const float squared = even * even + odd * odd;
    const float in_phase = (squared - across) / (std::sqrt(squared) + kLeastEnergy);
    sum[2 * i] += std::max(in_phase - noise, 0.0F);
    sum[2 * i + 1] += amplitude;
  }
}

/// Energy over amplitude. Each response's energy is at most its amplitude: where that is zero, so are both.
cv::Mat ratioOf(const cv::Mat& sums) {
  cv::Mat result(sums.size(), CV_32FC1);
  const auto* sum = sums.ptr<float>();
  auto* ratio = result.ptr<float>();
  const std::size_t count = sums.total();
  for (std::size_t i = 0; i < count; ++i)
    ratio[i] = sum[2 * i] / std::max(sum[2 * i + 1], std::numeric_limits<float>::min());
  return result;
}

/// spectrum * radial * angular.
void filter(const cv::Mat& spectrum, const cv::Mat& radial, const cv::Mat& angular, cv::Mat& result) {
  result.create(spectrum.size(), CV_32FC2);
  const auto *in = spectrum.ptr<float>(), *r = radial.ptr<float>(), *a = angular.ptr<float>();
  auto* out = result.ptr<float>();
  const std::size_t count = spectrum.total();
  for (std::size_t i = 0; i < count; ++i) {
    const float gain = r[i] * a[i];
    out[2 * i] = gain * in[2 * i];
    out[2 * i + 1] = gain * in[2 * i + 1];
  }
}

}  // namespace

PhaseCongruency::PhaseCongruency(const cv::Size& size) : size_(size), noise_per_median_{} {
  if (size.width < 2 || size.height < 2) throw std::invalid_argument("too small for phase congruency");
  std::array<cv::Mat, kScales> radial;
  for (int s = 0; s < kScales; ++s) {
    auto& filter = radial[static_cast<std::size_t>(s)];
    filter = overFrequencies(size, [&](double x, double y) { return logGabor(std::hypot(x, y), s); });
    filter.convertTo(radial_[static_cast<std::size_t>(s)], CV_32F);
  }
  // Of noise: Rayleigh's distribution, its mean and sigma, of parameter tau.
  constexpr double pi = std::numbers::pi;
  const double per_tau = (std::sqrt(pi / 2) + kNoiseSigmas * std::sqrt(2 - pi / 2)) / kNoiseOverestimate;
  for (std::size_t o = 0; o < kOrientations; ++o) {
    const cv::Mat angular =
        overFrequencies(size, [&](double x, double y) { return spread(x, y, static_cast<int>(o)); });
    angular.convertTo(angular_[o], CV_32F);
    const cv::Mat all_scales = (radial[0] + radial[1] + radial[2] + radial[3]).mul(angular);
    noise_per_median_[o] =
        per_tau * std::sqrt(noiseRatio(all_scales, radial[0].mul(angular)) / std::numbers::ln2);
  }
}

cv::Mat PhaseCongruency::of(const cv::Mat& luminance) const {
  if (luminance.size() != size_ || luminance.type() != CV_32FC1)
    throw std::invalid_argument("phase congruency: an image of another size or type");
  if (isFlat(luminance)) return cv::Mat::zeros(size_, CV_32FC1);
  const cv::Mat spectrum = spectrumOf(luminance);
  cv::Mat sums = cv::Mat::zeros(size_, CV_32FC2);
  Responses responses;
  for (std::size_t o = 0; o < kOrientations; ++o) {
    for (std::size_t s = 0; s < kScales; ++s) {
      filter(spectrum, radial_[s], angular_[o], responses[s]);
      cv::dft(responses[s], responses[s], cv::DFT_INVERSE);
    }
    accumulate(responses, noiseEnergy(responses[0], o), sums);
  }
  return ratioOf(sums);
}

float PhaseCongruency::noiseEnergy(const cv::Mat& finest, std::size_t orientation) const {
  std::vector<float> energies(finest.total());
  const auto* part = finest.ptr<float>();
  for (std::size_t i = 0; i < energies.size(); ++i)
    energies[i] = part[2 * i] * part[2 * i] + part[2 * i + 1] * part[2 * i + 1];
  return static_cast<float>(noise_per_median_[orientation]) * std::sqrt(median(energies));
}

}  // namespace fathom
