#pragma once

#include <array>

#include "similarity/measure.h"

namespace fathom {

/// FSIM, see fsim.h.
struct FsimMeasure {
  static constexpr std::string_view id = "fsim";
  static constexpr std::string_view about = "feature similarity of luminance (Zhang et al. 2011), 0 to 1";
  static constexpr std::array<Quantity, 1> quantities{{{"fsim", "1", Better::higher}}};

  static MeasureOutcome measure(const PairView& pair) { return outcomeOf(pair, &FsimScore::fsim); }

  static MeasureOutcome outcomeOf(const PairView& pair, double FsimScore::*which) {
    if (const auto why = FsimComparer::whyNot(pair->recorded)) return notMeasured(*why);
    if (!pair.fsim()) return notMeasured("there is nothing to see in either image");
    return {{(*pair.fsim()).*which}, ""};
  }
};

/// The same with colour.
struct FsimcMeasure {
  static constexpr std::string_view id = "fsimc";
  static constexpr std::string_view about =
      "feature similarity of luminance and colour (Zhang et al. 2011), 0 to 1";
  static constexpr std::array<Quantity, 1> quantities{{{"fsimc", "1", Better::higher}}};

  static MeasureOutcome measure(const PairView& pair) {
    return FsimMeasure::outcomeOf(pair, &FsimScore::fsimc);
  }
};

}  // namespace fathom
