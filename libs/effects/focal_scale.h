#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct FocalScale {
  template <class T>
  using Stage = Intrinsics<T>;
  static constexpr std::string_view id = "focal-scale";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "The focal length is not the calibration's",
      .equation = "fx_true = fx (1 + scale_error), fy likewise",
      .source = "Pinhole model, Hartley & Zisserman 2004, sec. 6.1",
      .confused_with = {"marker-size", "flat-port-refraction", "dvl-scale"},
      .told_apart =
          "Markers off the axis or aslant, and a second absolute scale (DVL): head on, it is a "
          "wrong marker size"};
  static constexpr std::array parameters{
      Parameter{.name = "scale_error",
                .unit = "1",
                .prior_sigma = 0.01,
                .limit = 0.5,
                .usual = "true/nominal - 1, within 0.02; in air instead of water -0.25"}};
  template <class T>
  static void apply(const T* p, Stage<T>& lens) {
    lens.fx_px *= T(1.0) + p[0];
    lens.fy_px *= T(1.0) + p[0];
  }
};

}  // namespace fathom
