#pragma once

#include <array>
#include <cmath>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Lamp {
  template <class T>
  using Stage = SceneLight<T>;
  static constexpr std::string_view id = "lamp";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "The vehicle's lamps shine: on what is near them, and on the water before the camera",
      .equation =
          "irradiance of each lamp = irradiance_1m_rel S cos(incidence) exp(-a d) / d^2 at the scene,\n"
          "d away, S = 2^-((1 - cos(angle)) / (1 - cos(half_angle))); the line of sight gets, a metre,\n"
          "exp(ln_scatter) (1 - g^2) / (1 + g^2 - 2 g cos(scattering angle))^1.5 times the share of the\n"
          "irradiance there that makes daylight build up the veil; g: asymmetry. In full daylight white has "
          "0.87",
      .source =
          "Jaffe 1990, eqs. 1 to 7 (inverse square, attenuation, single scattering along the line of "
          "sight); the beam's profile: von Mises and Fisher's, half as bright at the half angle; Henyey & "
          "Greenstein 1941, whose g of the sea is 0.9 and more (Mobley 1994, ch. 3)",
      .confused_with = {"vignetting", "separate-backscatter", "slant-range"},
      .told_apart =
          "The same surface near and far, and to either side: a lamp's light dies away with the square of "
          "the distance from where the lamp is; vignetting stays with the image"};
  static constexpr std::array parameters{
      Parameter{.name = "irradiance_1m_rel",
                .unit = "1",
                .prior_sigma = 0.5,
                .limit = 1000,
                .positive = true,
                .usual = "one lamp's, on its axis at 1 m without water, 1 makes white as bright as daylight "
                         "does: 0.1 to 3"},
      Parameter{
          .name = "ln_scatter",
          .unit = "1",
          .prior_sigma = 1,
          .limit = 10,
          .optional = true,
          .usual = "of what the water scatters of the lamps' light, over what it does of daylight: -1 to 1"},
      Parameter{
          .name = "asymmetry",
          .unit = "1",
          .prior_sigma = 0.5,
          .limit = 0.999,
          .optional = true,
          .usual = "of that scattering; forward is positive: 0.8 to 0.95, back to the camera comes little"}};
  static constexpr double kWhiteInDaylight = 0.87;  ///< radiance of white by irradiance 1
  template <class T>
  static void apply(const T* p, Stage<T>& light) {
    using std::exp;
    light.lamps += p[0] * kWhiteInDaylight;
    light.scattered *= exp(p[1]);
    light.asymmetry += p[2];
  }
};

}  // namespace fathom
