#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "imaging/water.h"
#include "observables/synchronized_images.h"

/// Task T_E: the paper's water, fitted. For each channel, attenuation a, veil b and ambient light E in
///
///     radiance = gain (albedo E exp(-a z) + (1 - exp(-a z)) b)
///
/// (predictLight() of imaging/image_model.h), the gain one an image; with what known effects make of it.
///
/// The water is estimated twice, by one model and with one prior (imaging/image_patch.h, imaging/water.h):
/// here from images at known poses, by many patches, gains and misread patches told apart; and in the batch
/// estimate (libs/estimation) along with poses, panels and effects, which starts from this one.
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

/// Robust maximum likelihood over all patches at once (Ceres). The start does not depend on luck: for each a
/// of a grid the model is linear in E and b, and the best of these, by a robust cost, is refined with
/// Cauchy's loss; then least squares over the inliers. What patches vary by beyond their own sigma (JPEG,
/// texture, misregistration) is found by making the median residual what it should be.
///
/// The covariance is that of least squares, each sigma enlarged by the correlation that the residuals of one
/// group of patches are found to have: of one image (pose, exposure), or, in a channel, of one digital number
/// (rounding, JPEG). The largest counts.
WaterFit fitWater(const std::vector<Patch>& patches, std::size_t images, const WaterFitOptions& options = {});

/// What a patch should read, and how far it is off in its sigmas (0 where a channel does not count).
Vector3d predictedRadiance(const Patch& patch, const Environment& environment, const KnownLight& known = {},
                           double log_gain = 0);
Vector3d residualSigmas(const Patch& patch, const WaterFit& fit);

/// The base model's water, near enough for an estimate to start from: by some of the patches, evenly. Nothing
/// where none can be fitted.
std::optional<Environment> startWater(const SynchronizedImages& synchronized);

}  // namespace fathom
