#pragma once

#include <array>
#include <cmath>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct FlatField {
  template <class T>
  using Stage = PixelResponse<T>;
  static constexpr std::string_view id = "flat-field";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "One side of the image gets, or counts, more light than the other",
      .equation =
          "light at the sensor = exp(slope . (x, y)) light, x right and y down: tangents of the line of "
          "sight's "
          "angle to the optical axis",
      .source =
          "First term of a flat field, as by a lens that is off the sensor's middle, a port that is dirty or "
          "fogs on one side, a sensor whose amplifiers differ; EMVA Standard 1288, release 4 (shading)",
      .confused_with = {"vignetting", "illumination-gradient", "lamp"},
      .told_apart =
          "The same surfaces on both sides of the image, from more than one place: a flat field stays with "
          "the "
          "image, what falls on the panel stays with that"};
  static constexpr std::array parameters{
      Parameter{.name = "slope",
                .unit = "1",
                .size = 2,
                .prior_sigma = 0.1,
                .limit = 3,
                .usual = "of the logarithm of light, x right and y down, by a tangent of 1; within 0.3"}};
  template <class T>
  static void apply(const T* p, Stage<T>& pixel) {
    using std::exp;
    pixel.gain *= exp(p[0] * pixel.image_tangent.x() + p[1] * pixel.image_tangent.y());
  }
};

}  // namespace fathom
