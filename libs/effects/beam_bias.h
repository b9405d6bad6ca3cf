#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct BeamBias {
  template <class T>
  using Stage = DvlVelocity<T>;
  static constexpr std::string_view id = "beam-bias";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "A beam of the DVL reads a speed of its own besides the robot's",
      .equation =
          "speed along beam k = axis_k . velocity + bias_k; velocity_read: least squares over the beams",
      .source =
          "Janus configuration, RD Instruments 1996 (ADCP principles of operation), sec. 4; a transducer "
          "or its channel with a zero error",
      .confused_with = {"water-current", "accelerometer-bias", "dvl-misalignment"},
      .told_apart =
          "Headings: a current is constant in the world, a beam's bias on the robot; at rest it is there "
          "too, "
          "a scale or a misalignment is not"};
  /// Of four beams the first three: had all the same but for their signs, + - + -, the velocity would be
  /// right. A fourth beam's alone is b, -b, b of the others.
  static constexpr std::array parameters{
      Parameter{.name = "bias_m_s",
                .unit = "m/s",
                .size = 3,
                .prior_sigma = 0.01,
                .limit = 1,
                .usual = "of beams 1, 2, 3, the fourth being right, within 0.02; of beam 4 alone: b, -b, b"}};
  static constexpr DerivedParameter derived{.name = "beam", .unit = "", .size = 1};
  /// The one that is off most, once all four have so much of + - + - that they are off least together.
  static Vector3d derive(const double* p, const DerivedFrom&) {
    const Eigen::Vector4d found(p[0], p[1], p[2], 0), unseen(1, -1, 1, -1);
    Eigen::Vector4d least = found;
    for (int k = 0; k < 3; ++k)
      if (const Eigen::Vector4d other = found - found[k] * unseen[k] * unseen;
          other.lpNorm<1>() < least.lpNorm<1>())
        least = other;
    Eigen::Index beam = 0;
    least.cwiseAbs().maxCoeff(&beam);
    return Vector3d::Constant(1.0 + static_cast<double>(beam));
  }
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    if (reading.beams.count() < 3) return;
    const Eigen::Matrix3Xd solution = reading.beams.solution();
    for (int k = 0; k < 3; ++k) reading.velocity_dvl += solution.col(k).template cast<T>() * p[k];
  }
};

}  // namespace fathom
