#pragma once

#include <array>
#include <cmath>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct IlluminationGradient {
  template <class T>
  using Stage = SceneLight<T>;
  static constexpr std::string_view id = "illumination-gradient";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "One side of the panel is in brighter daylight than the other",
      .equation =
          "daylight at the scene = exp(g . (x, y)) daylight, g the gradient, x right and y up from the "
          "middle "
          "of the "
          "panel's face; lamps and the veil stay. Beside the panel: as at its edge",
      .source =
          "First term of log light over the panel. Daylight falls by the diffuse attenuation with depth, "
          "0.03 "
          "to 0.5 per m (Kirk 2011); what stands above the panel shades one side",
      .confused_with = {"vignetting", "lamp", "slant-range"},
      .told_apart =
          "The same surfaces in the middle of the image and at its edges: a gradient stays with the panel, "
          "vignetting with the image, lamps with the vehicle"};
  static constexpr std::array parameters{
      Parameter{.name = "gradient_per_m",
                .unit = "1/m",
                .size = 2,
                .prior_sigma = 0.1,
                .limit = 10.0,
                .usual = "of the logarithm of daylight, x right and y up on the panel, within 0.3"}};
  template <class T>
  static void apply(const T* p, Stage<T>& light) {
    using std::exp;
    light.daylight *= exp(p[0] * light.at_panel_m.x() + p[1] * light.at_panel_m.y());
  }
};

}  // namespace fathom
