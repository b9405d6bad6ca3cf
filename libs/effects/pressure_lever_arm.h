#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Depth;

struct PressureLeverArm {
  template <class T>
  using Stage = Mounting<T, Depth>;
  static constexpr std::string_view id = "pressure-lever-arm";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The pressure sensor sits elsewhere on the robot",
      .equation = "position of the sensor = nominal position + offset_m, robot frame",
      .source = "Rigid body: the depth of a point beside the middle changes with roll and pitch",
      .confused_with = {"pressure-offset", "ins-misalignment"},
      .told_apart =
          "Roll and pitch: what is off along the robot shows as it pitches, what is off to its side as it "
          "rolls; upright it is a pressure offset"};
  static constexpr std::array parameters{Parameter{.name = "offset_m",
                                                   .unit = "m",
                                                   .size = 3,
                                                   .prior_sigma = 0.2,
                                                   .limit = 20,
                                                   .usual = "x y z, true minus nominal, within 0.5"}};
  template <class T>
  static void apply(const T* p, Stage<T>& mount) {
    for (int i = 0; i < 3; ++i) mount.position_robot[i] += p[i];
  }
};

}  // namespace fathom
