#pragma once

#include <array>
#include <cmath>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct WhiteBalance {
  template <class T>
  using Stage = PixelResponse<T>;
  static constexpr std::string_view id = "white-balance";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "The camera weighs its colours anew for each image",
      .equation =
          "light at the sensor, of colour c = exp(g_c) light, g_c of each image drawn from a normal curve "
          "of\n"
          "standard deviation log_gain_sd[c]. Gains that are always the same are the light's own colour",
      .source =
          "Gray-world and white-patch balance (Buchsbaum 1980; Barnard et al. 2002): diagonal gains, by what "
          "each image shows",
      .confused_with = {"auto-exposure", "sun-flicker", "turbidity-plume"},
      .told_apart =
          "Colours that go up and down against each other, black as well as white, near as well as far: "
          "exposure takes all colours alike, water the far ones"};
  static constexpr std::array parameters{Parameter{.name = "log_gain_sd",
                                                   .unit = "1",
                                                   .size = 3,
                                                   .prior_sigma = 0.1,
                                                   .limit = 3,
                                                   .kind = ParameterKind::spread,
                                                   .positive = true,
                                                   .usual = "of red, green, blue; 0.02 to 0.3"}};
  /// p: what was drawn for this image.
  template <class T>
  static void apply(const T* p, Stage<T>& pixel) {
    using std::exp;
    for (int c = 0; c < 3; ++c) pixel.gain[c] *= exp(p[c]);
  }
};

}  // namespace fathom
