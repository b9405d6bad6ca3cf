#pragma once

#include <array>

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
          "the share of the irradiance there that makes daylight build up the veil. 0.87 is full daylight",
      .source =
          "Jaffe 1990, eqs. 1 to 7 (inverse square, attenuation, single scattering along the line of "
          "sight); the beam's profile: von Mises and Fisher's, half as bright at the half angle",
      .confused_with = {"vignetting", "separate-backscatter", "slant-range"},
      .told_apart =
          "The same surface near and far, and to either side: a lamp's light dies away with the square of "
          "the distance from where the lamp is; vignetting stays with the image"};
  static constexpr std::array parameters{Parameter{
      .name = "irradiance_1m_rel",
      .unit = "1",
      .prior_sigma = 0.5,
      .limit = 1000,
      .positive = true,
      .usual = "one lamp's, on its axis at 1 m without water, where full daylight is 0.87: 0.1 to 3"}};
  static constexpr double kFullDaylight = 0.87;
  template <class T>
  static void apply(const T* p, Stage<T>& light) {
    light.lamps += p[0] / kFullDaylight;
  }
};

}  // namespace fathom
