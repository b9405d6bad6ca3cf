#pragma once

#include <array>
#include <cmath>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct DecentredDome {
  template <class T>
  using Stage = DomePort<T>;
  static constexpr std::string_view id = "dome-port";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "The camera looks through a dome whose centre is not its own: lines of sight bend",
      .equation =
          "n sin(theta) is the same in air (1), glass (1.5) and water (1.34), theta from the normal of "
          "concentric spheres\n"
          "outer radius radius_m, inner radius thickness_m less; the camera is at offset_m from their "
          "centre, in "
          "its own axes",
      .source =
          "She, Nakath, Song & Koeser 2022 (refractive geometry for underwater domes); a camera in the "
          "dome's centre sees as in air, with which the intrinsics are",
      .confused_with = {"flat-port-refraction", "focal-scale", "lens-distortion", "camera-misalignment"},
      .told_apart =
          "Markers near and far, across the whole image: along the axis it is a focal length with some "
          "distortion that changes with range, aside an image that is tilted"};
  static constexpr std::array parameters{
      Parameter{
          .name = "offset_m",
          .unit = "m",
          .size = 3,
          .prior_sigma = 0.005,
          .limit = 0.1,
          .usual =
              "the camera's centre from the dome's, camera axes, within 0.01 of a port that was centred"},
      Parameter{
          .name = "radius_m",
          .unit = "m",
          .prior_sigma = 0.4,
          .limit = 10.0,
          .kind = ParameterKind::shape,
          .at_zero = kUsualDome_m,
          .optional = true,
          .usual = "of the outer sphere; domes of 4 to 8 inches: 0.05 to 0.1; known to a factor of 1.5"},
      Parameter{.name = "thickness_m",
                .unit = "m",
                .prior_sigma = 0.5,
                .limit = 1.0,
                .kind = ParameterKind::shape,
                .at_zero = kUsualDomeGlass_m,
                .optional = true,
                .usual = "of the glass, 0.003 to 0.01; known to a factor of 1.6"}};
  template <class T>
  static void apply(const T* p, Stage<T>& dome) {
    dome.present = true;
    for (int i = 0; i < 3; ++i) dome.centre_m[i] -= p[i];
    dome.log_radius += p[3];
    using std::exp;
    dome.glass_m += kUsualDomeGlass_m * exp(p[4]);
  }
};

}  // namespace fathom
