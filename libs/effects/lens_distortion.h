#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct LensDistortion {
  template <class T>
  using Stage = Intrinsics<T>;
  static constexpr std::string_view id = "lens-distortion";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "The lens distorts otherwise than the calibration says",
      .equation =
          "x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)\n"
          "y_d = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y\n"
          "k1_true = k1 + k1_error; k2, p1, p2, and the principal point cx, cy likewise",
      .source = "Brown 1966, in OpenCV's notation",
      .confused_with = {"flat-port-refraction", "camera-misalignment", "focal-scale"},
      .told_apart = "Markers in the corners of the image, at several ranges: it does not depend on range"};
  static constexpr std::array parameters{Parameter{.name = "k1_error",
                                                   .unit = "1",
                                                   .prior_sigma = 0.05,
                                                   .limit = 5.0,
                                                   .usual = "true - nominal, within 0.05"},
                                         Parameter{.name = "k2_error",
                                                   .unit = "1",
                                                   .prior_sigma = 0.05,
                                                   .limit = 5.0,
                                                   .usual = "true - nominal, within 0.05"},
                                         Parameter{.name = "p1_error",
                                                   .unit = "1",
                                                   .prior_sigma = 0.002,
                                                   .limit = 1.0,
                                                   .optional = true,
                                                   .usual = "true - nominal, within 0.002"},
                                         Parameter{.name = "p2_error",
                                                   .unit = "1",
                                                   .prior_sigma = 0.002,
                                                   .limit = 1.0,
                                                   .optional = true,
                                                   .usual = "true - nominal, within 0.002"},
                                         Parameter{.name = "cx_error_px",
                                                   .unit = "px",
                                                   .prior_sigma = 2,
                                                   .limit = 100.0,
                                                   .optional = true,
                                                   .usual = "true - nominal, within 2"},
                                         Parameter{.name = "cy_error_px",
                                                   .unit = "px",
                                                   .prior_sigma = 2,
                                                   .limit = 100.0,
                                                   .optional = true,
                                                   .usual = "true - nominal, within 2"}};
  template <class T>
  static void apply(const T* p, Stage<T>& lens) {
    lens.k1 += p[0];
    lens.k2 += p[1];
    lens.p1 += p[2];
    lens.p2 += p[3];
    lens.cx_px += p[4];
    lens.cy_px += p[5];
  }
};

}  // namespace fathom
