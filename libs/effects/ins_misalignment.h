#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/rotation_vector.h"
#include "effects/stages.h"

namespace fathom {

struct Ins;

struct InsMisalignment {
  template <class T>
  using Stage = Mounting<T, Ins>;
  static constexpr std::string_view id = "ins-misalignment";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The INS is mounted at another angle than the drawing says",
      .equation =
          "R_robot_ins,true = R_robot_ins,nominal Exp(rotation_deg)\n"
          "of gyro, accelerometer and attitude alike",
      .source = "Farrell 2008, ch. 11 (alignment)",
      .confused_with = {"dvl-misalignment", "accelerometer-bias", "camera-misalignment"},
      .told_apart =
          "Turning about more than one axis, and a sensor that sees the world (camera, DVL) beside "
          "it"};
  static constexpr std::array parameters{Parameter{.name = "rotation_deg",
                                                   .unit = "deg",
                                                   .size = 3,
                                                   .prior_sigma = 1.0,
                                                   .limit = 180.0,
                                                   .usual = "rotation vector, INS frame, within 2 deg"}};
  template <class T>
  static void apply(const T* p, Stage<T>& mounting) {
    mounting.R_robot_sensor = mounting.R_robot_sensor * rotationFromDegrees<T>({p[0], p[1], p[2]});
  }
};

}  // namespace fathom
