#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "environment/fitted_water.h"
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
