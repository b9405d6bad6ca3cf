#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct ForwardScatter {
  template <class T>
  using Stage = WaterRay<T>;
  static constexpr std::string_view id = "forward-scatter";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title =
          "Some of the light that the water takes is only bent: what is bright shines on what is beside it",
      .equation =
          "light = exp(-a z) scene + (exp(-(1 - scattered_fraction) a z) - exp(-a z)) blurred scene,\n"
          "the blur 2 degrees a bend, each anywhere on the way: variance (2 deg)^2 / 3 n / (1 - exp(-n))\n"
          "with n = scattered_fraction a z bends in the mean",
      .source =
          "Jaffe 1990, eqs. 8 and 9 (forward scattered light as the direct one blurred); bends as Poisson's "
          "law has them, of a phase function as narrow as Petzold 1972 measured",
      .confused_with = {"separate-backscatter", "slant-range"},
      .told_apart =
          "Small and large surfaces of one albedo side by side: blur takes from a small white one what it "
          "gives to the black beside it, the veil gives to both"};
  static constexpr std::array parameters{
      Parameter{.name = "scattered_fraction",
                .unit = "1",
                .prior_sigma = 0.2,
                .limit = 1,
                .positive = true,
                .usual = "share of the attenuation that is forward scatter: 0.05 to 0.5"}};
  template <class T>
  static void apply(const T* p, Stage<T>& ray) {
    ray.bends += p[0] * ray.signal_depth;
  }
};

}  // namespace fathom
