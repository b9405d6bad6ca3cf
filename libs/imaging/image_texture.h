#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "effects/registry.h"

/// What interpolated colours and compression leave in the noise of plain surfaces, where means show neither:
/// two ratios of variances, of an image's numbers of eight bits. Both are one, and their logarithms zero, for
/// any noise that is alike all over the image, whatever its spectrum, and for any scene that is smooth.
///
/// - Chessboard: of second differences of green (the four neighbours minus four times the pixel), on the
///   pixels whose two coordinates add up to an odd number over on the others. Where green is interpolated its
///   second difference vanishes (Gallagher & Chen 2008).
/// - Blocks: of squared steps of brightness across borders of blocks of 8 pixels over within them. Each block
///   is rounded by itself (JPEG: ITU-T T.81).
///
/// To each of the four variances is added what rounding to whole numbers makes of it: or else a surface that
/// compression has left without any noise would have a ratio of nothing over nothing.
namespace fathom {

/// Red, green and blue in an image's brightness (ITU-R BT.601, as JPEG has it).
inline constexpr std::array kLumaWeights{0.299, 0.587, 0.114};
/// Of the brightness's noise variance over that of three colours that are alike.
inline constexpr double kLumaShare =
    kLumaWeights[0] * kLumaWeights[0] + kLumaWeights[1] * kLumaWeights[1] + kLumaWeights[2] * kLumaWeights[2];
/// What rounding adds, DN²: to each colour's variance, to a second difference's, to a step's of brightness.
inline constexpr double kRounding_dn2 = 1.0 / 12;
inline constexpr double kRoundedCurve_dn2 = 20 * kRounding_dn2;
inline constexpr double kRoundedStep_dn2 = 2 * kLumaShare * kRounding_dn2;

/// A part of the pixels that the ratios are of, which are about as noisy.
struct NoiseLevel {
  double share = 0;      ///< of them all
  double green_dn2 = 0;  ///< noise variance of green, before it is rounded
  double luma_dn2 = 0;   ///< that of brightness
  double slope_dn2 = 0;  ///< mean square of the brightness's slope from pixel to pixel, along either axis
};

/// Logarithms of an image's two ratios: chessboard, blocks.
struct ImageTexture {
  double t_s = 0;  ///< the image's stamp, since the recording's first entry
  std::size_t image = 0, eye = 0;
  Eigen::Vector2d log_ratio = Eigen::Vector2d::Zero();
  Eigen::Vector2d sigma = Eigen::Vector2d::Ones();
  std::vector<NoiseLevel> noise;
};

/// Variances of second differences of white noise of variance one, measured and interpolated green:
/// neighbours of a measured pixel share it, and at an interpolated one the four measured neighbours cancel.
template <class T>
struct CurveVariances {
  T measured, interpolated;

  explicit CurveVariances(const T& share)
      : measured(4.0 * (1.0 - share) * (1.0 - share) + (4.0 - share) * (4.0 - share) + 1.25 * share * share),
        interpolated(20.0 * (1.0 - share) * (1.0 - share)) {}
};

/// By how much less brightness steps from pixel to pixel, as a variance, of noise that is white and alike in
/// all three colours: the interpolation (RGGB, bilinear) is linear, so this is quadratic in its share. Summed
/// up over the pattern's four pixels and both directions.
template <class T>
T lumaLeftOf(const T& share) {
  constexpr double kBoth = 0.318, kInterpolated = 0.332;
  return (1.0 - share) * (1.0 - share) + 2.0 * kBoth * share * (1.0 - share) + kInterpolated * share * share;
}

/// What rounding to multiples of a step does to a normal variable of this variance and mean zero.
///
/// Up to a step of 2.4 sigma by Widrow & Kollar's series (2008), in whose sums only the step's square occurs;
/// beyond, bin by bin. Both to 1e-12.
template <class T>
struct RoundedNormal {
  T variance;  ///< after rounding
  T gain;      ///< covariance of before and after over the variance before (Bussgang 1952)

  RoundedNormal(const T& before, const T& step2) : variance(before + step2 / 12.0), gain(1.0) {
    using std::erfc, std::exp, std::sqrt;
    constexpr double kPi2 = std::numbers::pi * std::numbers::pi;
    if (step2 <= 0.0 || before > 2.0 * step2) return;
    if (step2 < 6.0 * before) {
      double sign = -1;
      for (int n = 1; n <= 3; ++n, sign = -sign) {
        const T left = sign * exp(-2.0 * kPi2 * n * n * before / step2);
        variance += left * (4.0 * before + step2 / (kPi2 * n * n));
        gain += 2.0 * left;
      }
      return;
    }
    const T steps = sqrt(step2 / before);  // in sigmas
    variance = T(0.0);
    gain = T(0.0);
    for (int m = 1; m <= 3; ++m) {
      const T low = (m - 0.5) * steps;
      variance += static_cast<double>(2 * m - 1) * step2 * erfc(low / std::numbers::sqrt2);
      gain += std::sqrt(2 / std::numbers::pi) * steps * exp(-0.5 * low * low);
    }
  }
};

/// Mean square of the difference of two numbers that were rounded to multiples of a step, of normal
/// differences of this variance, wherever between two multiples they are: of a difference d it is
/// d² + f (1 - f) step², f being the part of d / step behind the point.
template <class T>
T roundedDifference(const T& variance, const T& step2) {
  using std::exp, std::sqrt;
  constexpr double kPi2 = std::numbers::pi * std::numbers::pi;
  if (variance <= 1e-12) return T(0.0);
  if (step2 > 64.0 * variance) return sqrt(2.0 / std::numbers::pi * variance * step2);  // one step, or none
  T square = variance + step2 / 6.0;
  if (step2 <= 0.0 || variance > 2.0 * step2) return square;
  for (int n = 1; n <= 11; ++n)
    square -= step2 * exp(-2.0 * kPi2 * n * n * variance / step2) / (kPi2 * n * n);
  return square;
}

/// The cosine transform of a block, and what of it steps are.
struct BlockTransform {
  static constexpr int kSide = 8;
  using Axis = Eigen::Array<double, kSide, 1>;
  using Table = Eigen::Array<double, kSide, kSide>;

  Axis at_border;  ///< of each frequency, its wave at the block's first pixel; at the last one: + - + - …
  Axis of_step;    ///< mean square of its steps within the block
  Axis of_slope;   ///< what a slope of one a pixel has of it, the other axis being even: of odd ones
  Table steps;     ///< of the luminance table that JPEG suggests, over its first entry

  static const BlockTransform& instance();

 private:
  BlockTransform();
};

/// Mean square steps of brightness, DN², across borders of blocks and within them.
template <class T>
struct BlockSteps {
  T across, within;
};

/// Of what was rounded by blocks, the first entry to multiples of a step whose square this is.
///
/// Before it there are white noise and slopes, which are taken as normal. Coefficients of noise stay
/// uncorrelated; those of a slope are alike in neighbouring blocks, and what of it is rounded away within
/// blocks is left for their borders. Neighbouring blocks' means lie anywhere between two multiples. Behind it
/// numbers are rounded again, brightness and colours, which leaves alone what has no noise any more. Means of
/// blocks are multiples of an eighth of the first step: what rounding adds to steps between them is that of
/// normal ones while that is small, and nothing from 1 DN on (a curve that was fitted).
template <class T>
BlockSteps<T> roundedSteps(const T& noise_dn2, double slope_dn2, const T& quantum_dn2) {
  using std::erf, std::exp, std::sqrt;
  constexpr int kSide = BlockTransform::kSide;
  const BlockTransform& block = BlockTransform::instance();
  constexpr double kMeanSlope = 64;  // of a block's first coefficient, from block to block
  const double flat = block.at_border[0];
  T across = flat * flat *
             (roundedDifference(T(2.0 * noise_dn2 + kMeanSlope * kMeanSlope * slope_dn2), quantum_dn2) -
              kMeanSlope * kMeanSlope * slope_dn2);
  T within(0.0), sloping(kMeanSlope * flat), is_plain(1.0);
  for (int u = 0; u < kSide; ++u)
    for (int v = 0; v < kSide; ++v) {
      if (u == 0 && v == 0) continue;
      const double slope2 = v == 0   ? block.of_slope[u] * block.of_slope[u] * slope_dn2
                            : u == 0 ? block.of_slope[v] * block.of_slope[v] * slope_dn2
                                     : 0.0;
      const T before = noise_dn2 + slope2, step2 = quantum_dn2 * (block.steps(u, v) * block.steps(u, v));
      const RoundedNormal<T> rounded(before, step2);
      const double border2 = block.at_border[u] * block.at_border[u];
      across += 2.0 * border2 * (rounded.variance - rounded.gain * rounded.gain * slope2);
      within += block.of_step[u] * rounded.variance;
      if (v == 0) sloping += 2.0 * block.at_border[u] * block.of_slope[u] * rounded.gain;
      const bool is_fine = step2 < 0.01 * before;  // then some coefficient surely is not rounded to nothing
      is_plain = is_fine ? T(0.0) : T(is_plain * erf(sqrt(step2 / (8.0 * before))));
    }
  across += sloping * sloping * slope_dn2;
  across /= static_cast<double>(kSide);
  within /= static_cast<double>(kSide);
  const T busy = 1.0 - is_plain;
  const T behind =
      busy < 1e-13 ? T(0.0) : T(busy * (roundedDifference(T(within / busy), T(1.0)) - within / busy));
  const T at_border = roundedDifference(across, T(1.0)) - across;
  const T fine_means = exp(-quantum_dn2 * quantum_dn2 / (36.0 * 36.0));
  return {across + behind + (at_border - behind) * fine_means + is_plain * (kLumaShare * kRounding_dn2),
          within + behind};
}

/// What the ratios' logarithms should be.
///
/// A table's steps are whole numbers, 1 at least, so that qualities of more than 97 hardly differ; and steps
/// that went on to nothing would first add noise, of fine waves more than of others, which is less at borders
/// than within. So from a first step of kFinest_dn downwards the blocks' logarithm falls in proportion
/// instead, by which a fit finds its way from nothing; and the chessboard comes back.
template <class T>
Eigen::Matrix<T, 2, 1> textureOf(const std::vector<NoiseLevel>& noise, const ImageCoding<T>& coding) {
  using std::log, std::sqrt;
  constexpr double kFinest_dn = 0.96;
  const T square = coding.quantum_dn * coding.quantum_dn;
  const T quantum_dn2 = sqrt(square * square + std::pow(kFinest_dn, 4));
  const T coded = coding.quantum_dn / sqrt(quantum_dn2);  // 0: not at all, 1: as roundedSteps() has it
  const CurveVariances<T> curves(coding.interpolated);
  T measured(2 * kRoundedCurve_dn2), interpolated(2 * kRoundedCurve_dn2);
  BlockSteps<T> steps{T(kRoundedStep_dn2), T(kRoundedStep_dn2)};
  for (const NoiseLevel& level : noise) {
    // Numbers are rounded before they are coded: each colour, and brightness.
    const T luma_dn2 = level.luma_dn2 * lumaLeftOf(coding.interpolated) + (1.0 + kLumaShare) * kRounding_dn2;
    const BlockSteps<T> own = roundedSteps(luma_dn2, level.slope_dn2, quantum_dn2);
    steps.across += level.share * own.across;
    steps.within += level.share * own.within;
    // A chessboard is of the finest waves, which are the first to be rounded away.
    const double finest = BlockTransform::instance().steps.bottomRightCorner<4, 4>().mean();
    const T gain = RoundedNormal<T>(luma_dn2, T(quantum_dn2 * (finest * finest))).gain;
    const T left = 1.0 - coded * coded * (1.0 - gain * gain);
    const T mean = 0.5 * (curves.measured + curves.interpolated),
            apart = 0.5 * left * (curves.measured - curves.interpolated);
    measured += level.share * level.green_dn2 * (mean + apart);
    interpolated += level.share * level.green_dn2 * (mean - apart);
  }
  return {log(measured / interpolated), log(steps.across / steps.within) * coded};
}

/// The same of the effects that are on, in an image stamped t_s.
template <class T>
Eigen::Matrix<T, 2, 1> predictTexture(const std::vector<NoiseLevel>& noise,
                                      const EffectParameters<T>& effects, double t_s) {
  ImageCoding<T> coding;
  applyEffects(effects, t_s, coding);
  return textureOf(noise, coding);
}

/// The quality, 1 to 100, with which libjpeg codes as an effect has it; nothing where images are not
/// compressed.
std::optional<int> codingQuality(const ImageCoding<double>& coding);

}  // namespace fathom
