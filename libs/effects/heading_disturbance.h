#pragma once

#include <array>

#include "core/scalar.h"
#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct HeadingDisturbance {
  template <class T>
  using Stage = HeadingReading<T>;
  static constexpr std::string_view id = "heading-disturbance";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "Iron near the vehicle turns the compass",
      .equation =
          "heading_read = heading_true + amplitude_deg exp(-|position - place_m|^2 / (2 reach_m^2))\n"
          "without a reach the disturbance is the same everywhere",
      .source = "A static field added to the Earth's: Gebre-Egziabher et al. 2006, sec. 2, for small angles",
      .confused_with = {"ins-misalignment", "dvl-misalignment", "gyro-bias"},
      .told_apart = "Passing the place again, on other headings; another source of heading or position"};
  static constexpr std::array parameters{
      Parameter{.name = "amplitude_deg",
                .unit = "deg",
                .prior_sigma = 5,
                .limit = 180,
                .usual = "2 to 20 deg within some metres of a steel structure; declination left out: any"},
      Parameter{.name = "reach_m",
                .unit = "m",
                .prior_sigma = 10,
                .limit = 1000,
                .positive = true,
                .optional = true,
                .other_start = 5,
                .usual = "2 to 20 m; 0: everywhere"},
      Parameter{.name = "place_m",
                .unit = "m",
                .size = 3,
                .prior_sigma = 10,
                .limit = 1e5,
                .optional = true,
                .usual = "of the iron, odom"}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    using std::exp;
    T share = T(1.0);
    if (valueOf(p[1]) > 0) {
      const Vector3<T> away = reading.position_odom - Vector3<T>(p[2], p[3], p[4]);
      share = exp(-0.5 * away.squaredNorm() / (p[1] * p[1]));
    }
    reading.heading_rad += p[0] * T(radians(1.0)) * share;
  }
};

}  // namespace fathom
