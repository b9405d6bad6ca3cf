#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct WaterCurrent {
  template <class T>
  using Stage = DvlVelocity<T>;
  static constexpr bool is_of_world = true;  ///< each instrument of the kind is in it
  static constexpr std::string_view id = "water-current";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The DVL tracks the moving water, not the ground",
      .equation = "velocity_read = R_dvl_odom (velocity_odom - current_m_s)",
      .source = "Hegrenaes & Berglund 2009 (water-track DVL aiding)",
      .confused_with = {"dvl-scale", "dvl-misalignment", "accelerometer-bias"},
      .told_apart =
          "More than one heading: a current is constant in the world, a bias or a scale in the body"};
  static constexpr std::array parameters{Parameter{
      .name = "current_m_s",
      .unit = "m/s",
      .size = 3,
      .prior_sigma = 0.2,
      .limit = 5.0,
      .usual = "the water's velocity in odom, within 0.5 m/s, z near 0; active_s where the bottom was "
               "not tracked"}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.velocity_dvl -= reading.R_odom_dvl.transpose() * Vector3<T>(p[0], p[1], p[2]);
  }
};

}  // namespace fathom
