#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Dvl;

struct DvlLeverArm {
  template <class T>
  using Stage = Mounting<T, Dvl>;
  static constexpr std::string_view id = "dvl-lever-arm";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The DVL sits elsewhere than the drawing says",
      .equation =
          "position_robot,true = position_robot,nominal + offset_m\n"
          "seen as a velocity omega x offset_m",
      .source = "Rigid-body kinematics, v_dvl = v + omega x l",
      .confused_with = {"dvl-latency", "ins-latency"},
      .told_apart = "Turning on the spot; a latency shows while speeding up, too"};
  static constexpr std::array parameters{Parameter{.name = "offset_m",
                                                   .unit = "m",
                                                   .size = 3,
                                                   .prior_sigma = 0.1,
                                                   .limit = 20.0,
                                                   .usual = "true - nominal, robot frame, within 0.3 m"}};
  template <class T>
  static void apply(const T* p, Stage<T>& mounting) {
    mounting.position_robot += Vector3<T>(p[0], p[1], p[2]);
  }
};

}  // namespace fathom
