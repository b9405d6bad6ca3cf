#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct GyroBias {
  template <class T>
  using Stage = GyroReading<T>;
  static constexpr std::string_view id = "gyro-bias";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The gyro reads a rate that is not there",
      .equation = "rate_read = rate_true + bias_rad_s",
      .source =
          "Additive bias model, Farrell 2008, ch. 11. The simulator draws it from the data sheet's "
          "sigma, the filter can carry it as a state",
      .confused_with = {"earth-rotation", "dvl-misalignment", "gyro-scale"},
      .told_apart = "Attitudes far apart against the Earth's rotation, which is constant in the world"};
  static constexpr std::array parameters{
      Parameter{.name = "bias_rad_s",
                .unit = "rad/s",
                .size = 3,
                .prior_sigma = 1e-3,
                .limit = 1.0,
                .usual = "read - true, INS frame; MEMS 1e-4 to 1e-2, fibre-optic below 1e-6"}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.angular_velocity_ins += Vector3<T>(p[0], p[1], p[2]);
  }
};

}  // namespace fathom
