#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Demosaicing {
  template <class T>
  using Stage = ColourInterpolation<T>;
  static constexpr std::string_view id = "demosaicing";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "Each pixel measures one colour only, the others are interpolated from its neighbours",
      .equation =
          "DN = (1 - interpolated) d + interpolated d', d' being the bilinear interpolation of d in a Bayer "
          "pattern (green on every other pixel, red and blue on every fourth)",
      .source =
          "Gallagher & Chen 2008: noise of second differences is less where a colour is interpolated, with a "
          "period of two pixels; Gunturk et al. 2005 (bilinear interpolation)",
      .confused_with = {"defocus", "image-compression"},
      .told_apart =
          "Noise of plain surfaces: with two variances, one on each colour of a chessboard of pixels, "
          "however "
          "soft edges are; compression removes it again, and leaves blocks"};
  static constexpr std::array parameters{
      Parameter{.name = "interpolated",
                .unit = "1",
                .prior_sigma = 0.5,
                .limit = 1.5,
                .positive = true,
                .usual = "1 of an ordinary camera that interpolates bilinearly; 0.5 to 1 of others"}};
  template <class T>
  static void apply(const T* p, Stage<T>& image) {
    image.interpolated += p[0];
  }
};

}  // namespace fathom
