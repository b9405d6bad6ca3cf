#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Sharpening {
  static constexpr double kRadius_px = 1;  ///< standard deviation of the blurred copy

  template <class T>
  using Stage = ImageSoftness<T>;
  static constexpr std::string_view id = "sharpening";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "The camera sharpens its images: edges are harder, with a rim beside them",
      .equation =
          "DN = d + amount (d - d blurred by 1 px), d as the sensor reads; an edge's variance shrinks by "
          "amount "
          "(1 px)^2",
      .source =
          "Unsharp masking (Polesel, Ramponi & Mathews 2000); second moment of a kernel (1 + a) delta - a G",
      .confused_with = {"defocus", "edge-bias"},
      .told_apart =
          "Rims: darker and brighter than either surface within two pixels of an edge; what is softer has "
          "none"};
  static constexpr std::array parameters{Parameter{.name = "amount",
                                                   .unit = "1",
                                                   .prior_sigma = 0.8,
                                                   .limit = 3,
                                                   .positive = true,
                                                   .usual = "0.2 to 1.5 of ordinary cameras"}};
  template <class T>
  static void apply(const T* p, Stage<T>& image) {
    image.sharpened_px2 += kRadius_px * kRadius_px * p[0];
  }
};

}  // namespace fathom
