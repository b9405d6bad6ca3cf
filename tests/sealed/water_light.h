#pragma once

#include <Eigen/Core>

#include "sealed_case.h"

/// Water and daylight. Colours are linear red, green, blue; 1 is the camera's full scale.
namespace fathom::sealed {

using Eigen::Array3d;

/// As they are at one time.
struct WaterLight {
  Array3d attenuation_per_m;       ///< of the scene's light, a
  Array3d veil_attenuation_per_m;  ///< at whose rate the veil builds up; a unless something is hidden
  Array3d veil;                    ///< what endless water looks like, b
  Array3d daylight;                ///< irradiance at the scene: what a surface of albedo 1 shines with
  double slant_share;              ///< 0: light dies away along the optical axis, 1: along its way
  double scattered_fraction;       ///< share of the attenuation that only bends light

  /// How much water there is between the camera and a point.
  double path_m(double depth_m, double range_m) const { return depth_m + slant_share * (range_m - depth_m); }
  Array3d transmission(double path) const { return (-attenuation_per_m * path).exp(); }
  /// The veil of so much water (DexROV's equation; its own rate: Akkaynak & Treibitz 2018, eq. 20).
  Array3d veilBefore(double path) const { return veil * (1 - (-veil_attenuation_per_m * path).exp()); }
};

/// `log_sun`: of this image, standard normal.
WaterLight waterLightAt(const SealedCase& sealed, double t_s, double log_sun);

}  // namespace fathom::sealed
