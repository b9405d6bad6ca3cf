#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct GyroScale {
  template <class T>
  using Stage = GyroReading<T>;
  static constexpr std::string_view id = "gyro-scale";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The gyro turns more, or less, than the vehicle",
      .equation = "rate_read = rate_true (1 + scale_error)",
      .source = "Scale factor model, Farrell 2008, ch. 11; IEEE Std 952",
      .confused_with = {"gyro-bias", "ins-misalignment"},
      .told_apart = "Turns both ways (a bias does not change sign), and an attitude or position reference"};
  static constexpr std::array parameters{
      Parameter{.name = "scale_error",
                .unit = "1",
                .prior_sigma = 5e-3,
                .limit = 0.5,
                .usual = "measured/true - 1, all axes; MEMS 1e-3 to 2e-2, fibre-optic below 1e-4"}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.angular_velocity_ins *= T(1.0) + p[0];
  }
};

}  // namespace fathom
