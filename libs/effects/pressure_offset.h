#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct PressureOffset {
  template <class T>
  using Stage = PressureReading<T>;
  static constexpr std::string_view id = "pressure-offset";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The pressure sensor's zero, or the day's air pressure, is not the vehicle file's",
      .equation = "pressure_read = pressure_true + offset_pa",
      .source = "Additive bias model",
      .confused_with = {"pressure-density", "panel-moved"},
      .told_apart =
          "Another height reference: alone it is identical to an error of the vehicle's height in "
          "odom"};
  static constexpr std::array parameters{
      Parameter{.name = "offset_pa",
                .unit = "Pa",
                .prior_sigma = 1000.0,
                .limit = 1e6,
                .usual = "read - true, within 2000 Pa (weather); 100 Pa is 1 cm of water"}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.pressure_pa += p[0];
  }
};

}  // namespace fathom
