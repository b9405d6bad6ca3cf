#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct RollingShutter {
  template <class T>
  using Stage = Shutter<T>;
  static constexpr std::string_view id = "rolling-shutter";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "The image's rows are not taken at once",
      .equation =
          "time of row v = time of validity + readout_s v / image height\n"
          "the first row is the one that the time stamp is of",
      .source = "Meingast et al. 2005; Oth et al. 2013",
      .confused_with = {"camera-latency", "lens-distortion"},
      .told_apart = "Fast sideways motion or turning while markers fill the image from top to bottom"};
  static constexpr std::array parameters{
      Parameter{.name = "readout_s",
                .unit = "s",
                .prior_sigma = 0.02,
                .limit = 1.0,
                .usual = "from the first row to behind the last, 0.005 to 0.06 s; negative: from below"}};
  template <class T>
  static void apply(const T* p, Stage<T>& shutter) {
    shutter.rolling = true;
    shutter.readout_s += p[0];
  }
};

}  // namespace fathom
