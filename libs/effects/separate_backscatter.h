#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct SeparateBackscatter {
  template <class T>
  using Stage = WaterRay<T>;
  static constexpr std::string_view id = "separate-backscatter";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "The veil builds up at another rate than the scene's light dies away",
      .equation =
          "light = scene exp(-a z) + veil (1 - exp(-(a + backscatter_difference_per_m) z)), of each colour\n"
          "backscatter_attenuation_per_m = a + backscatter_difference_per_m",
      .source = "Akkaynak & Treibitz 2018, eq. 20",
      .confused_with = {"gamma", "dark-offset", "slant-range"},
      .told_apart = "White and black side by side at many ranges: their difference has no veil in it"};
  static constexpr std::array parameters{
      Parameter{.name = "backscatter_difference_per_m",
                .unit = "1/m",
                .size = 3,
                .prior_sigma = 0.1,
                .limit = 10,
                .usual = "red, green, blue: the veil's attenuation minus the scene's, within 0.3"}};
  static constexpr DerivedParameter derived{.name = "backscatter_attenuation_per_m", .unit = "1/m"};
  /// Red, green, blue.
  static Vector3d derive(const double* p, const DerivedFrom& from) {
    return from.attenuation_per_m + Vector3d(p[0], p[1], p[2]);
  }
  template <class T>
  static void apply(const T* p, Stage<T>& ray) {
    for (int c = 0; c < 3; ++c) ray.veil_depth[c] += p[c] * ray.z_m;
  }
};

}  // namespace fathom
