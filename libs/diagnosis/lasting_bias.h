#pragma once

#include "estimation/batch_data.h"

namespace fathom {

/// What a channel's readings can be off by for no reason of their own however often they are taken, reading's
/// own unit. Of markers' corners what the pixels' lattice leaves, of edges what renderers differ by; of
/// others nothing is known.
constexpr double lastingBias(BatchChannel channel) {
  if (channel == BatchChannel::markers) return 0.003;
  return channel == BatchChannel::edges ? 0.001 : 0;
}

}  // namespace fathom
