#pragma once

#include <array>
#include <cmath>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct SunFlicker {
  template <class T>
  using Stage = SceneLight<T>;
  static constexpr std::string_view id = "sun-flicker";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "Waves focus the sun: the daylight at the panel is another in each image",
      .equation =
          "daylight at the scene = exp(f) daylight, f of each image drawn from a normal curve of standard\n"
          "deviation log_light_sd; the veil, lit all along the line of sight, stays",
      .source =
          "Stramski & Dera 1988 (downward irradiance under waves fluctuates, less the deeper); of a panel at "
          "once, finer patterns are not resolved",
      .confused_with = {"auto-exposure", "turbidity-plume"},
      .told_apart =
          "Black surfaces far away: they show the veil, which a gain of the camera changes and the sun does "
          "not"};
  static constexpr std::array parameters{
      Parameter{.name = "log_light_sd",
                .unit = "1",
                .prior_sigma = 0.1,
                .limit = 3,
                .kind = ParameterKind::spread,
                .positive = true,
                .usual = "0.02 to 0.5 near the surface, none below some tens of metres"}};
  /// p: what was drawn for this image.
  template <class T>
  static void apply(const T* p, Stage<T>& light) {
    using std::exp;
    light.daylight *= exp(p[0]);
  }
};

}  // namespace fathom
