#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/rotation_vector.h"
#include "effects/stages.h"

namespace fathom {

struct Camera;

struct CameraMisalignment {
  template <class T>
  using Stage = Mounting<T, Camera>;
  static constexpr std::string_view id = "camera-misalignment";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "The camera looks elsewhere than the drawing says",
      .equation =
          "R_robot_camera,true = R_robot_camera,nominal Exp(rotation_deg)\n"
          "of a pair: the left one, the right one with it",
      .source = "Hand-eye calibration, Tsai & Lenz 1989",
      .confused_with = {"ins-misalignment", "panel-moved", "camera-latency"},
      .told_apart = "More than one heading: it is fixed in the body, a misplaced panel in the world"};
  static constexpr std::array parameters{Parameter{.name = "rotation_deg",
                                                   .unit = "deg",
                                                   .size = 3,
                                                   .prior_sigma = 1.0,
                                                   .limit = 180.0,
                                                   .usual = "rotation vector, camera frame, within 2 deg"}};
  template <class T>
  static void apply(const T* p, Stage<T>& mounting) {
    mounting.R_robot_sensor = mounting.R_robot_sensor * rotationFromDegrees<T>({p[0], p[1], p[2]});
  }
};

}  // namespace fathom
