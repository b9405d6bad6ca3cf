#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct FlatWaterSurface {
  template <class T>
  using Stage = WaterSurface<T>;
  static constexpr std::string_view id = "flat-water-surface";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title =
          "The camera is in air and looks down through the water's flat surface: lines of sight bend there",
      .equation =
          "n sin(theta) is the same in air (1) and water (water_index), theta from the surface's normal\n"
          "the surface is at odom z = z + water_m, z being that of the first panel's origin in the map\n"
          "its normal = Exp(tilt_deg, tilt_y_deg, 0) z, odom; it passes through the point over that origin\n"
          "a point at lateral distance r from the normal through the camera, d below the surface:\n"
          "r = distance_m tan(theta_air) + d tan(theta_water)\n"
          "distance_m: the camera's mean height over the surface\n"
          "under 0.05 m of water, what is higher or lower than the origin counts as nearer to its height\n"
          "only of a camera whose section of the vehicle file says `above_water: true`",
      .source =
          "Agrawal et al. 2012 (two layers with one normal). Water is level: what tilts it is a map, or a "
          "path, "
          "that is not. Index: Quan & Fry 1995, 1.331 (warm, fresh) to 1.345 (cold, salt)",
      .confused_with = {"flat-port-refraction", "focal-scale", "lens-distortion", "marker-size"},
      .told_apart =
          "Views aslant, from all sides: the bending goes with the angle to the vertical, that of a port "
          "with the angle to the camera's axis. Straight down over a level panel, water is a panel that is "
          "nearer by a quarter of its depth; at 30 deg off the vertical that depth seems 7 % less yet"};
  static constexpr std::array parameters{
      Parameter{.name = "water_m",
                .unit = "m",
                .prior_sigma = 0.5,
                .limit = 100.0,
                .positive = true,
                .other_start = 0.3,
                .usual = "of water over the first panel's origin, along the vertical: 0.1 to 1.5 m"},
      Parameter{.name = "tilt_deg",
                .unit = "deg",
                .prior_sigma = 1.0,
                .limit = 60.0,
                .kind = ParameterKind::shape,
                .optional = true,
                .usual = "the surface's turn about odom's x axis: 0 where the map's z axis is vertical"},
      Parameter{.name = "tilt_y_deg",
                .unit = "deg",
                .prior_sigma = 1.0,
                .limit = 60.0,
                .kind = ParameterKind::shape,
                .optional = true,
                .usual = "the same about odom's y axis"},
      Parameter{.name = "water_index",
                .unit = "1",
                .prior_sigma = 0.003,
                .limit = 2.0,
                .kind = ParameterKind::shape,
                .at_zero = kWaterIndex,
                .optional = true,
                .usual = "refractive index by temperature and salinity, 1.331 to 1.345; known to 0.3 %"}};
  static constexpr DerivedParameter derived{.name = "distance_m", .unit = "m", .size = 1};
  static Vector3d derive(const double* p, const DerivedFrom& from) {
    return {from.camera_over_panel_m - p[0], 0, 0};
  }
  template <class T>
  static void apply(const T* p, Stage<T>& surface) {
    surface.present = true;
    surface.water_m += p[0];
    surface.tilt_x_rad += p[1] * T(radians(1.0));
    surface.tilt_y_rad += p[2] * T(radians(1.0));
    surface.log_index += p[3];
  }
};

}  // namespace fathom
