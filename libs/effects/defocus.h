#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Defocus {
  template <class T>
  using Stage = ImageSoftness<T>;
  static constexpr std::string_view id = "defocus";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "The lens is not in focus: all edges are softer",
      .equation =
          "light at the sensor = light, blurred by a normal curve of standard deviation blur_px; an edge's "
          "variance grows by its square, to all sides alike",
      .source =
          "Subbarao & Surya 1994, depth from defocus: of a circle of confusion, as of any blur, edges tell "
          "the "
          "second moment",
      .confused_with = {"motion-blur", "forward-scatter", "sharpening"},
      .told_apart =
          "Standing still and moving, near and far: it is the same in both, motion smears along its way "
          "only, "
          "water the farther the more"};
  static constexpr std::array parameters{
      Parameter{.name = "blur_px",
                .unit = "px",
                .prior_sigma = 0.7,
                .limit = 5,
                .positive = true,
                .squared = true,
                .usual = "standard deviation, besides that of lens and pixels in focus: 0.3 to 2"}};
  template <class T>
  static void apply(const T* p, Stage<T>& image) {
    image.lens_px2 += p[0];
  }
};

}  // namespace fathom
