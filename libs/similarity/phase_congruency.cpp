#include "similarity/phase_congruency.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "similarity/wide_vectors.h"

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
SplitImage spectrumOf(const cv::Mat& luminance) {
  cv::Mat centred, spectrum;
  luminance.convertTo(centred, CV_32F, 1, -cv::mean(luminance)[0]);
  cv::dft(centred, spectrum, cv::DFT_COMPLEX_OUTPUT);
  spectrum *= 1.0 / static_cast<double>(luminance.total());
  std::array<cv::Mat, 2> parts;
  cv::split(spectrum, parts.data());
  return {parts[0], parts[1]};
}

/// The mean of the two middle ones of an even count. The order of non-negative floats is that of their bits:
/// counting by the upper ones leaves few to be put in order.
float median(const std::vector<float>& values) {
  constexpr unsigned shift = 18;
  const auto binOf = [](float value) { return std::bit_cast<std::uint32_t>(value) >> shift; };
  std::vector<std::size_t> counts(std::size_t{1} << (32 - shift), 0);
  for (const float value : values) ++counts[binOf(value)];
  const auto atRank = [&](std::size_t rank) {
    std::uint32_t bin = 0;
    while (rank >= counts[bin]) rank -= counts[bin++];
    std::vector<float> candidates;
    std::copy_if(values.begin(), values.end(), std::back_inserter(candidates),
                 [&](float value) { return binOf(value) == bin; });
    const auto middle = candidates.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(candidates.begin(), middle, candidates.end());
    return *middle;
  };
  const float upper = atRank(values.size() / 2);
  return values.size() % 2 == 1 ? upper : 0.5F * (atRank(values.size() / 2 - 1) + upper);
}

/// The even (real) and odd (imaginary) answers of an orientation's filters, fine to coarse.
using Responses = std::array<SplitImage, PhaseCongruency::kScales>;

/// Adds an orientation's energy above the noise, and its amplitudes. The energy is the sum over scales of a
/// response's part along the mean phase, less its part across.
FATHOM_WIDE_VECTORS void accumulate(const Responses& responses, float noise, cv::Mat& energy,
                                    cv::Mat& amplitude) {
  const auto *e0 = responses[0].real.ptr<float>(), *o0 = responses[0].imaginary.ptr<float>(),
             *e1 = responses[1].real.ptr<float>(), *o1 = responses[1].imaginary.ptr<float>(),
             *e2 = responses[2].real.ptr<float>(), *o2 = responses[2].imaginary.ptr<float>(),
             *e3 = responses[3].real.ptr<float>(), *o3 = responses[3].imaginary.ptr<float>();
  auto *energies = energy.ptr<float>(), *amplitudes = amplitude.ptr<float>();
  const auto count = static_cast<std::ptrdiff_t>(energy.total());
  FATHOM_INDEPENDENT
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    amplitudes[i] += std::sqrt(e0[i] * e0[i] + o0[i] * o0[i]) + std::sqrt(e1[i] * e1[i] + o1[i] * o1[i]) +
                     std::sqrt(e2[i] * e2[i] + o2[i] * o2[i]) + std::sqrt(e3[i] * e3[i] + o3[i] * o3[i]);
    const float e = e0[i] + e1[i] + e2[i] + e3[i], o = o0[i] + o1[i] + o2[i] + o3[i];
    const float across = std::abs(e0[i] * o - o0[i] * e) + std::abs(e1[i] * o - o1[i] * e) +
                         std::abs(e2[i] * o - o2[i] * e) + std::abs(e3[i] * o - o3[i] * e);
    const float squared = e * e + o * o;
    const float in_phase = (squared - across) / (std::sqrt(squared) + kLeastEnergy);
    energies[i] += in_phase > noise ? in_phase - noise : 0.0F;
  }
}

}  // namespace

PhaseCongruency::PhaseCongruency(const cv::Size& size) : size_(size), transform_(size), noise_per_median_{} {
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
  const SplitImage spectrum = spectrumOf(luminance);
  // Transposed, as the transforms leave them.
  cv::Mat energy = cv::Mat::zeros(size_.width, size_.height, CV_32FC1), amplitude = energy.clone();
  FilteredTransform::Workspace work = transform_.workspace();
  Responses responses;
  for (int o = 0; o < kOrientations; ++o) {
    for (std::size_t s = 0; s < kScales; ++s)
      transform_.run(spectrum, radial_[s], angular_[static_cast<std::size_t>(o)], work, responses[s]);
    accumulate(responses, noiseEnergy(responses[0], o), energy, amplitude);
  }
  // Each response's energy is at most its amplitude: where that is zero, so are both.
  amplitude = cv::max(amplitude, std::numeric_limits<float>::min());
  return cv::Mat((energy / amplitude).t());
}

float PhaseCongruency::noiseEnergy(const SplitImage& finest, int orientation) const {
  std::vector<float> energies(finest.real.total());
  const auto *even = finest.real.ptr<float>(), *odd = finest.imaginary.ptr<float>();
  for (std::size_t i = 0; i < energies.size(); ++i) energies[i] = even[i] * even[i] + odd[i] * odd[i];
  return static_cast<float>(noise_per_median_[static_cast<std::size_t>(orientation)]) *
         std::sqrt(median(energies));
}

}  // namespace fathom
