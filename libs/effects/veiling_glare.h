#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct VeilingGlare {
  template <class T>
  using Stage = StrayLight<T>;
  static constexpr std::string_view id = "veiling-glare";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "Lens and port strew some of the light over all of the image",
      .equation = "light at the sensor = (1 - glare_share) light + glare_share (its mean over the image)",
      .source =
          "ISO 9358 (veiling glare of image-forming systems): even over the image, the share that the "
          "standard "
          "measures as veiling glare index",
      .confused_with = {"dark-offset", "separate-backscatter", "gamma"},
      .told_apart =
          "Images with little and with much light besides: glare goes with all that the image shows, an "
          "offset "
          "with nothing, the veil with range"};
  static constexpr std::array parameters{
      Parameter{.name = "glare_share",
                .unit = "1",
                .prior_sigma = 0.03,
                .limit = 0.9,
                .positive = true,
                .usual = "0.005 to 0.05 of a good lens, more where a port is scratched or dirty"}};
  template <class T>
  static void apply(const T* p, Stage<T>& stray) {
    stray.share += p[0];
  }
};

}  // namespace fathom
