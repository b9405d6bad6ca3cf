#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Vignetting {
  template <class T>
  using Stage = PixelResponse<T>;
  static constexpr std::string_view id = "vignetting";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "The lens passes less light to the image's corners",
      .equation =
          "light at the sensor = (1 - corner_loss q - outer_loss (q^2 - q)) light, q = (radius / 0.72)^2\n"
          "radius: tangent of the line of sight's angle to the optical axis",
      .source =
          "Even polynomial in the radius, e.g. Goldman 2010, normalized to the corner of 640 x 480 at 555 px",
      .confused_with = {"slant-range", "gamma"},
      .told_apart =
          "The same surface in the middle and in the corners, at more than one range: the lens takes "
          "the same share of signal and veil at any range"};
  static constexpr std::array parameters{
      Parameter{.name = "corner_loss",
                .unit = "1",
                .prior_sigma = 0.2,
                .limit = 1,
                .usual = "share of the light lost at radius 0.72, 0.05 to 0.5"},
      Parameter{.name = "outer_loss",
                .unit = "1",
                .prior_sigma = 0.1,
                .limit = 1,
                .optional = true,
                .usual = "the same with the radius's fourth power: 0 of a plain quadratic fall"}};
  template <class T>
  static void apply(const T* p, Stage<T>& pixel) {
    constexpr double kCorner = 0.72;
    const T q = pixel.image_radius * pixel.image_radius / (kCorner * kCorner);
    pixel.gain *= 1.0 - p[0] * q - p[1] * (q * q - q);
  }
};

}  // namespace fathom
