#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct AccelerometerBias {
  template <class T>
  using Stage = AccelerometerReading<T>;
  static constexpr std::string_view id = "accelerometer-bias";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The accelerometer reads a specific force that is not there",
      .equation = "force_read = force_true + bias_m_s2",
      .source =
          "Additive bias model, Farrell 2008, ch. 11. The simulator draws it from the data sheet's "
          "sigma, the filter can carry it as a state",
      .confused_with = {"ins-misalignment", "dvl-latency"},
      .told_apart = "Tilting: level, x and y are the same as a tilt of the INS (9.8 mm/s^2 a milliradian)"};
  static constexpr std::array parameters{Parameter{.name = "bias_m_s2",
                                                   .unit = "m/s^2",
                                                   .size = 3,
                                                   .prior_sigma = 0.02,
                                                   .limit = 5.0,
                                                   .usual = "read - true, INS frame, 1e-3 to 0.1"}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.specific_force_ins += Vector3<T>(p[0], p[1], p[2]);
  }
};

}  // namespace fathom
