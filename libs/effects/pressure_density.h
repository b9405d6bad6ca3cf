#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct PressureDensity {
  template <class T>
  using Stage = SeaWater<T>;
  static constexpr std::string_view id = "pressure-density";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The water's density is not the vehicle file's",
      .equation = "pressure = p_air + (density + density_error_kg_m3) g depth",
      .source = "Hydrostatics; densities: UNESCO 1981 (EOS-80)",
      .confused_with = {"pressure-offset"},
      .told_apart =
          "Changing depth, and another height reference (markers, DVL): at one depth it is an "
          "offset"};
  static constexpr std::array parameters{
      Parameter{.name = "density_error_kg_m3",
                .unit = "kg/m^3",
                .prior_sigma = 10.0,
                .limit = 500.0,
                .usual = "true - vehicle file; sea water 1020 to 1030, fresh water 998"}};
  template <class T>
  static void apply(const T* p, Stage<T>& water) {
    water.density_kg_m3 += p[0];
  }
};

}  // namespace fathom
