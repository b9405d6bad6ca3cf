#pragma once

#include <array>
#include <vector>

#include "estimation/linearization.h"

namespace fathom {

/// The noise that one channel shows, in its axes together.
struct ChannelNoise {
  bool present = false;
  double scale = 1;        ///< sigma in units of the one stated
  double correlation = 0;  ///< of neighbours in a track: a first-order autoregression
  double correlation_error = 0;
  double tail = 0;  ///< excess kurtosis
};

struct NoiseModel {
  std::array<ChannelNoise, kBatchChannels.size()> channels;  ///< by BatchChannel
  /// What the panel's markers scatter by about where the map has them, one axis; 0: the map is exact.
  double panel_tolerance_m = 0;
};

}  // namespace fathom
