#pragma once

#include <algorithm>
#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct BeamMissing {
  template <class T>
  using Stage = DvlVelocity<T>;
  static constexpr std::string_view id = "beam-missing";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "A beam of the DVL hears nothing, or too little, and counts nevertheless",
      .equation =
          "speed along beam k = axis_k . velocity (1 - missing_k); velocity_read: least squares over "
          "the beams",
      .source =
          "Janus configuration, RD Instruments 1996 (ADCP principles of operation), sec. 4; a driver "
          "that fills a beam without an echo with zero instead of solving with the other three",
      .confused_with = {"dvl-scale", "dvl-misalignment"},
      .told_apart =
          "Directions: along the beam's plane speed is too low and part of it turns up in the vertical; "
          "across "
          "it nothing is off. A scale is the same in all directions, a turn makes no speed less"};
  static constexpr auto ofBeam = [](std::string_view name) {
    return Parameter{.name = name,
                     .unit = "1",
                     .prior_sigma = 0.3,
                     .limit = 1,
                     .positive = true,
                     .usual = "share of its speed that is lost: 1 of a beam that counts as zero"};
  };
  static constexpr std::array parameters{ofBeam("missing_1"), ofBeam("missing_2"), ofBeam("missing_3"),
                                         ofBeam("missing_4")};
  static constexpr DerivedParameter derived{.name = "beam", .unit = "", .size = 1};
  /// The one that lacks most.
  static Vector3d derive(const double* p, const DerivedFrom&) {
    return Vector3d::Constant(1.0 + static_cast<double>(std::max_element(p, p + 4) - p));
  }
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    if (reading.beams.count() < 3) return;
    const Eigen::Matrix3Xd solution = reading.beams.solution();
    const Vector3<T> heard = reading.velocity_dvl;
    for (std::ptrdiff_t k = 0; k < std::min<std::ptrdiff_t>(4, reading.beams.count()); ++k)
      reading.velocity_dvl -=
          solution.col(k).template cast<T>() * (reading.beams.axis(k).template cast<T>().dot(heard) * p[k]);
  }
};

}  // namespace fathom
