#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct DvlScale {
  template <class T>
  using Stage = DvlVelocity<T>;
  static constexpr std::string_view id = "dvl-scale";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The DVL assumes a sound speed that is not the water's, or has a scale error of its own",
      .equation = "velocity_read = velocity_true (1 + scale_error)",
      .source =
          "Kinsey & Whitcomb 2006, sec. 3; sound speed: Mackenzie 1981. A phased-array DVL is wrong"
          " in the vertical only",
      .confused_with = {"water-current", "marker-size", "focal-scale"},
      .told_apart =
          "A second absolute scale (markers of known size), and more than one heading against a "
          "current"};
  static constexpr std::array parameters{
      Parameter{.name = "scale_error",
                .unit = "1",
                .prior_sigma = 0.02,
                .limit = 0.5,
                .usual = "measured/true - 1, within 0.02: v = v_used c/c_used, and c varies by 3.6 m/s a "
                         "degree Celsius and 1.2 m/s a unit of salinity at 10 degrees"}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.velocity_dvl *= T(1.0) + p[0];
  }
};

}  // namespace fathom
