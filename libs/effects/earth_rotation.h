#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct EarthRotation {
  static constexpr double kRate_rad_s = 7.292115e-5;  ///< WGS-84

  template <class T>
  using Stage = GyroReading<T>;
  static constexpr bool is_of_world = true;  ///< each instrument of the kind is in it
  static constexpr std::string_view id = "earth-rotation";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The gyro feels the Earth's rotation, which the nominal model leaves out",
      .equation =
          "rate_read = rate_true + R_ins_odom rate_rad_s\n"
          "rate_rad_s = 7.292e-5 (cos(latitude) north + sin(latitude) up), in odom",
      .source =
          "Groves 2013, sec. 2.4 (rate: WGS 84); Coriolis acceleration, 2 x 7e-5/s x speed, is "
          "below any accelerometer's bias",
      .confused_with = {"gyro-bias"},
      .told_apart =
          "Headings far apart and a gyro better than 1e-5 rad/s: a bias is constant in the body, "
          "this in the world"};
  static constexpr std::array parameters{
      Parameter{.name = "rate_rad_s",
                .unit = "rad/s",
                .size = 3,
                .prior_sigma = 4.2e-5,
                .limit = 1e-3,
                .usual = "the Earth's rotation in odom: 7.292e-5 in all, z being 7.292e-5 sin(latitude)"}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.angular_velocity_ins += reading.R_odom_ins.transpose() * Vector3<T>(p[0], p[1], p[2]);
  }
};

}  // namespace fathom
