#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/rotation_vector.h"
#include "effects/stages.h"

namespace fathom {

struct Dvl;

struct DvlMisalignment {
  template <class T>
  using Stage = Mounting<T, Dvl>;
  static constexpr std::string_view id = "dvl-misalignment";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The DVL is mounted at another angle than the drawing says",
      .equation = "R_robot_dvl,true = R_robot_dvl,nominal Exp(rotation_deg)",
      .source =
          "Kinsey & Whitcomb 2006 (in-situ alignment); Pan & Wu 2015, arXiv 1509.02054 "
          "(observability)",
      .confused_with = {"ins-misalignment", "gyro-bias", "water-current"},
      .told_apart =
          "Surge and sway, and a position reference: a constant heading error is identical without "
          "one"};
  static constexpr std::array parameters{
      Parameter{.name = "rotation_deg",
                .unit = "deg",
                .size = 3,
                .prior_sigma = 2.0,
                .limit = 180.0,
                .usual = "rotation vector, DVL frame, within 3 deg, mostly about z"}};
  template <class T>
  static void apply(const T* p, Stage<T>& mounting) {
    mounting.R_robot_sensor = mounting.R_robot_sensor * rotationFromDegrees<T>({p[0], p[1], p[2]});
  }
};

}  // namespace fathom
