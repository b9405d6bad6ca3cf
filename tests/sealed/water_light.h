#pragma once

#include <Eigen/Core>

#include "sealed_case.h"
#include "viewpoint.h"

/// Water and daylight. Colours are linear red, green, blue; 1 is the camera's full scale.
namespace fathom::sealed {

using Eigen::Array3d;

/// A ball of murky water, Gaussian in each direction. Lamps and snow are before it.
struct MurkyCloud {
  double peak_per_m = 0;  ///< attenuation besides, in its middle; zero: there is none
  double sigma_m = 1;
  Eigen::Vector3d middle_camera{0, 0, 0};

  /// What light loses along a straight line: exp(-depth) is left.
  double opticalDepth(const Eigen::Vector3d& from_camera, const Eigen::Vector3d& to_camera) const;
};

/// As they are at one time.
struct WaterLight {
  Array3d attenuation_per_m;       ///< of the scene's light, a
  Array3d veil_attenuation_per_m;  ///< at whose rate the veil builds up; a unless something is hidden
  Array3d veil;                    ///< what endless water looks like, b
  Array3d daylight;                ///< irradiance at the scene: what a surface of albedo 1 shines with
  double slant_share;              ///< 0: light dies away along the optical axis, 1: along its way
  double scattered_fraction;       ///< share of the attenuation that only bends light
  MurkyCloud cloud{};              ///< water that is murkier in one place

  /// How much water there is between the camera and a point.
  double path_m(double depth_m, double range_m) const { return depth_m + slant_share * (range_m - depth_m); }
  Array3d transmission(double path) const { return (-attenuation_per_m * path).exp(); }
  /// The veil of so much water (DexROV's equation; its own rate: Akkaynak & Treibitz 2018, eq. 20), and of a
  /// cloud of that optical depth: its water scatters as much of what it takes away as the rest does.
  Array3d veilBefore(double path, double cloud_depth = 0) const {
    return veil * (1 - (-veil_attenuation_per_m * path - cloud_depth).exp());
  }
};

/// `log_sun`: of this image, standard normal.
WaterLight waterLightAt(const SealedCase& sealed, double t_s, double log_sun);
/// Of a plume that is a cloud, in an image of that stamp: `panel_odom` is what it drifts by before.
MurkyCloud murkyCloudAt(const SealedCase& sealed, const Viewpoint& viewpoint, const Vector3d& panel_odom,
                        double stamp_s);

}  // namespace fathom::sealed
