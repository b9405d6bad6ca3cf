#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Gamma {
  template <class T>
  using Stage = ResponseCurve<T>;
  static constexpr std::string_view id = "gamma";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "The camera's response is another power than its data sheet says",
      .equation = "DN = full scale L^(g (1 + exponent_error)), g the data sheet's response_gamma",
      .source = "Grossberg & Nayar 2004 (response curves); DN = 255 L^g",
      .confused_with = {"separate-backscatter", "dark-offset"},
      .told_apart =
          "Bright and dark surfaces side by side at near and far range: a power bends what attenuation "
          "leaves straight"};
  static constexpr std::array parameters{
      Parameter{.name = "exponent_error",
                .unit = "1",
                .prior_sigma = 0.2,
                .limit = 0.9,
                .usual = "0 as stated; -0.55 where a linear camera turns out to be one of 1/2.2"}};
  template <class T>
  static void apply(const T* p, Stage<T>& curve) {
    curve.exponent *= 1.0 + p[0];
  }
};

}  // namespace fathom
