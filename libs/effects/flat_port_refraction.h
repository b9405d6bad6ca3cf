#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct FlatPortRefraction {
  template <class T>
  using Stage = FlatPort<T>;
  static constexpr std::string_view id = "flat-port-refraction";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title =
          "The camera looks through a flat window: lines of sight bend, and no longer meet in one "
          "point",
      .equation =
          "n sin(theta) is the same in air (1), glass (1.5) and water (1.34), theta from the one normal\n"
          "a point at lateral distance r from the normal through the camera, and h along it:\n"
          "r = distance_m tan(theta_air) + glass_m tan(theta_glass) + (h - distance_m - glass_m) "
          "tan(theta_water)\n"
          "normal = Exp(tilt_deg, tilt_y_deg, 0) z, camera frame\n"
          "nominal line of sight: n sin(theta) with n = 1.34 / (1 + index_error), in the same plane\n"
          "calibration_per_m: 1 over the range at which they were calibrated through the port, where they "
          "are right\n"
          "slab_m: one more layer, of an index 1.34 times that of what lies beyond it\n"
          "a vehicle's `window` adds its distance and tilt; up to it the nominal index holds",
      .source =
          "Treibitz et al. 2012; Agrawal et al. 2012 (layers with one normal). Distances of zero "
          "are a camera whose intrinsics already contain the bending, as those of a calibration "
          "under water do",
      .confused_with = {"focal-scale", "lens-distortion", "camera-misalignment", "marker-size"},
      .told_apart =
          "Markers near and far, across the whole image: at one range, or beyond about 1.5 m, a "
          "camera offset along the axis with k1 and k2 absorbs most of it (of distance_m = 0.02, "
          "seen 36 deg off the axis over 0.5 to 5 m by a camera of 555 px, 11 mm leave 0.3 px rms)"};
  static constexpr std::array parameters{
      Parameter{.name = "distance_m",
                .unit = "m",
                .prior_sigma = 0.03,
                .limit = 2.0,
                .positive = true,
                .usual = "camera's centre to the glass, 0.005 to 0.1 m; before a tank more"},
      Parameter{.name = "glass_m",
                .unit = "m",
                .prior_sigma = 0.01,
                .limit = 0.5,
                .positive = true,
                .usual = "thickness, 0.003 to 0.02 m"},
      Parameter{.name = "tilt_deg",
                .unit = "deg",
                .prior_sigma = 1.0,
                .limit = 60.0,
                .usual = "the normal's turn about the camera's x axis, within 2 deg"},
      Parameter{.name = "tilt_y_deg",
                .unit = "deg",
                .prior_sigma = 1.0,
                .limit = 60.0,
                .optional = true,
                .usual = "the normal's turn about the camera's y axis, within 2 deg"},
      Parameter{.name = "index_error",
                .unit = "1",
                .prior_sigma = 0.1,
                .limit = 0.5,
                .optional = true,
                .usual =
                    "1.34 over the index that the intrinsics contain, minus 1: 0 for a calibration under "
                    "water, 0.34 for one in air"},
      Parameter{.name = "slab_m",
                .unit = "m",
                .prior_sigma = 0.1,
                .limit = 2.0,
                .positive = true,
                .optional = true,
                .other_start = 0.1,
                .usual = "thickness of the water, where a camera in air looks through a tank and out again; "
                         "else 0"},
      Parameter{.name = "calibration_per_m",
                .unit = "1/m",
                .prior_sigma = 0.5,
                .limit = 10.0,
                .positive = true,
                .optional = true,
                .usual = "1 over the range at which the camera was calibrated under water through this port: "
                         "0.3 to 1; 0: far away"}};
  template <class T>
  static void apply(const T* p, Stage<T>& port) {
    port.present = true;
    port.distance_m += p[0];
    port.glass_m += p[1];
    port.tilt_x_rad += p[2] * T(radians(1.0));
    port.tilt_y_rad += p[3] * T(radians(1.0));
    port.index_error += p[4];
    port.slab_m += p[5];
    port.calibration_per_m += p[6];
  }
};

}  // namespace fathom
