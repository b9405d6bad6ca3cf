#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct ResponseBend {
  template <class T>
  using Stage = ResponseCurve<T>;
  static constexpr std::string_view id = "response-curve";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "Each colour of the camera answers by a curve that is no power of the light",
      .equation = "DN = full scale (r + bend[c] r (1 - r)), r = L^g, of colour c",
      .source =
          "Grossberg & Nayar 2004: cameras' curves differ from a mean one by few smooth shapes, of which the "
          "first bulges over all brightnesses; here the simplest of that kind that leaves black and white "
          "where they are",
      .confused_with = {"gamma", "dark-offset", "lamp"},
      .told_apart =
          "Surfaces of many brightnesses, each near and far: a bend is largest at half of full scale, a "
          "power "
          "near black, an offset is the same everywhere"};
  static constexpr std::array parameters{
      Parameter{.name = "bend",
                .unit = "1",
                .size = 3,
                .prior_sigma = 0.1,
                .limit = 0.9,
                .usual = "of red, green, blue; positive where half of full scale reads more, within 0.3"}};
  template <class T>
  static void apply(const T* p, Stage<T>& curve) {
    for (int c = 0; c < 3; ++c) curve.bend[c] += p[c];
  }
};

}  // namespace fathom
