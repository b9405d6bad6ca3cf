#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct DarkOffset {
  template <class T>
  using Stage = PixelResponse<T>;
  static constexpr std::string_view id = "dark-offset";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "The camera's numbers begin above, or below, zero",
      .equation = "DN = full scale (L^g + offset_share)",
      .source = "EMVA Standard 1288, release 4 (dark signal)",
      .confused_with = {"separate-backscatter", "gamma"},
      .told_apart =
          "Black surfaces from as near as can be to far: the veil is gone at range zero, an offset is not"};
  static constexpr std::array parameters{
      Parameter{.name = "offset_share",
                .unit = "1",
                .prior_sigma = 0.02,
                .limit = 0.5,
                .usual = "share of full scale, the same for each colour, within 0.05"}};
  template <class T>
  static void apply(const T* p, Stage<T>& pixel) {
    pixel.offset.array() += p[0];
  }
};

}  // namespace fathom
