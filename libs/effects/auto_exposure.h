#pragma once

#include <array>
#include <cmath>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct AutoExposure {
  template <class T>
  using Stage = PixelResponse<T>;
  static constexpr std::string_view id = "auto-exposure";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "The camera exposes each image for another time",
      .equation =
          "light at the sensor = exp(g) light, g of each image drawn from a normal curve of standard\n"
          "deviation log_gain_sd",
      .source =
          "Kim et al. 2008 (radiometric calibration with exposure changes): one gain on all of an image",
      .confused_with = {"sun-flicker", "turbidity-plume"},
      .told_apart =
          "Black as well as white, far as well as near: the gain takes the same share of signal and veil"};
  static constexpr std::array parameters{Parameter{.name = "log_gain_sd",
                                                   .unit = "1",
                                                   .prior_sigma = 0.1,
                                                   .limit = 3,
                                                   .kind = ParameterKind::spread,
                                                   .positive = true,
                                                   .usual = "0.02 to 0.5"}};
  /// p: what was drawn for this image.
  template <class T>
  static void apply(const T* p, Stage<T>& pixel) {
    using std::exp;
    pixel.gain *= exp(p[0]);
  }
};

}  // namespace fathom
