#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "diagnosis/candidate.h"
#include "diagnosis/scatter.h"

namespace fathom {

/// The noise that one channel shows.
struct ChannelNoise {
  std::size_t rows = 0;
  double scale = 1;        ///< sigma in units of the one stated (data sheet, or a corner's own covariance)
  double correlation = 0;  ///< of neighbours in a track: a first-order autoregression
  /// Degrees of freedom that the scale was taken from; infinite: as stated.
  double freedom = std::numeric_limits<double>::infinity();

  /// What the sigma is multiplied by where readings are taken as independent: a mean over many then scatters
  /// as it truly does.
  double independentScale() const;
};

struct NoiseModel {
  std::array<ChannelNoise, kChannelCount> channels;  ///< by Channel
  MarkerScatter markers;
  /// What patches of images scatter by besides, share of their light.
  double light_scatter = 0;
  PrintScatter print;

  const ChannelNoise& of(Channel channel) const { return channels[indexOf(channel)]; }
  /// Has a problem take readings for that noisy.
  void applyTo(ProblemOptions& options) const;
};

/// The noise that an estimate's residuals show once every effect of the catalogue may explain its share: what
/// is left out of the model is not taken for noise. Scale and correlation are those with which simulated
/// noise leaves the residuals seen, so what the estimate follows is accounted for. `linear`: weighted (see
/// applyRobustWeights()), at an estimate with the noise `assumed`; robust weights of light are taken anew, so
/// that what an effect explains is no outlier.
NoiseModel shownNoise(Linearization linear, const NoiseModel& assumed, std::uint64_t seed);

/// Rows of a track that follow one another without a gap: pairs of neighbours, by row.
std::vector<std::array<std::size_t, 2>> neighbours(const Linearization& linear, Channel channel);

}  // namespace fathom
