#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "effects/registry.h"
#include "imaging/water.h"
#include "sensors/vehicle.h"

/// What fitWater() is told, and what it finds.
namespace fathom {

using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// What is known of the light besides water and daylight. Light that is bent is taken to come from
/// surroundings lit like the patch itself: beside lamps, forward scattering is right to a percent of
/// attenuation only.
struct KnownLight {
  /// Those on light and on the camera's response count; without what is drawn for each image: gains make up
  /// for that.
  EffectParameters<double> effects;
  std::vector<LampSheet> lamps;  ///< the vehicle's
};

struct WaterFitOptions {
  enum class Gain { fixed, fitted, detected };
  Gain gain = Gain::detected;        ///< detected: fitted where images turn out to differ
  double log_gain_sigma = 0.3;       ///< prior
  double detected_log_gain = 0.005;  ///< gains whose spread is less are not worth fitting
  Environment start;                 ///< and centre of the prior, see wideWaterSigma()
  double largest_attenuation_per_m = 10;
  double inlier_probability = 0.9999;  ///< that a good patch counts
  KnownLight known;
};

struct WaterFit {
  bool solved = false;
  std::string why_not = "not run";

  KnownLight known;  ///< as the options had it
  Environment environment;
  /// In the order of waterParameters(). Grown where patches err alike.
  Matrix9d covariance = Matrix9d::Zero();
  Vector9d sigma_growth = Vector9d::Ones();  ///< by how much each parameter's sigma grew so
  bool gain_fitted = false;
  std::vector<double> log_gain, log_gain_sigma;  ///< one an image; their mean is 0. Empty where not fitted

  std::vector<bool> inlier;  ///< of each patch
  std::size_t images = 0, patches = 0, outliers = 0;
  Vector3d excess_sigma =
      Vector3d::Zero();  ///< what patches vary by besides their own sigma, found by the fit
  Vector3d chi_square_per_dof = Vector3d::Zero();  ///< with that; by channel
  double nearest_z_m = 0, farthest_z_m = 0;        ///< of the inliers
  std::vector<std::string> warnings;               ///< where ranges do not separate a from b; one line each

  Vector9d sigma() const { return covariance.diagonal().cwiseSqrt(); }
};

}  // namespace fathom
