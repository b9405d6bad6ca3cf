#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

/// An effect outside fathom's tree. Written like those inside it (libs/effects/README.md, or the README.md
/// among the installed documentation); `cmake -D FATHOM_EXTRA_EFFECTS=THIS_FILE:GyroNonlinearity` builds a
/// fathom that knows it.
namespace fathom {

struct GyroNonlinearity {
  template <class T>
  using Stage = GyroReading<T>;
  static constexpr std::string_view id = "gyro-nonlinearity";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The gyro's scale changes with the rate",
      .equation = "rate_read = rate_true (1 + cubic_s2_rad2 rate_true^2), axis by axis",
      .source = "IEEE Std 952-1997 (fibre-optic gyros), scale factor's nonlinearity",
      .confused_with = {"gyro-scale"},
      .told_apart = "Fast and slow turns: a scale error is the same share of both"};
  static constexpr std::array parameters{Parameter{.name = "cubic_s2_rad2",
                                                   .unit = "s^2/rad^2",
                                                   .prior_sigma = 0.1,
                                                   .limit = 2,
                                                   .usual = "share at 1 rad/s, within 0.1"}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    for (int axis = 0; axis < 3; ++axis) {
      T& rate = reading.angular_velocity_ins[axis];
      rate *= 1.0 + p[0] * rate * rate;
    }
  }
};

}  // namespace fathom
