#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct SlantRange {
  template <class T>
  using Stage = WaterRay<T>;
  static constexpr std::string_view id = "slant-range";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "Water acts along the line of sight, not along the optical axis",
      .equation =
          "both exponents a z become a (z + slant_share (r - z)), r the range along the line of sight\n"
          "slant_share = 1: a r; attenuation_per_m: a",
      .source = "Beer's law along the ray, e.g. Jaffe 1990; the base model's z is the paper's (DexROV 2018)",
      .confused_with = {"vignetting", "separate-backscatter"},
      .told_apart =
          "The same surface in the image's middle and in its corners, near and far: r / z is a "
          "matter of the image radius, what it does grows with range"};
  static constexpr std::array parameters{
      Parameter{.name = "slant_share",
                .unit = "1",
                .prior_sigma = 1.0,
                .limit = 10,
                .positive = true,
                .usual = "1 where light dies away along the line of sight, 0 along the axis"}};
  static constexpr DerivedParameter derived{.name = "attenuation_per_m", .unit = "1/m"};
  static Vector3d derive(const double*, const DerivedFrom& from) { return from.attenuation_per_m; }
  template <class T>
  static void apply(const T* p, Stage<T>& ray) {
    const T stretch = 1.0 + p[0] * (ray.range_m / ray.z_m - 1.0);
    ray.signal_depth *= stretch;
    ray.veil_depth *= stretch;
  }
};

}  // namespace fathom
