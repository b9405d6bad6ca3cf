#pragma once

#include <algorithm>
#include <vector>

#include "core/random.h"
#include "imaging/image_model.h"
#include "imaging/water.h"
#include "observables/patches.h"

/// Patches as images of a panel would give them, without images.
namespace fathom::test {

struct PatchPlan {
  std::size_t images = 50, patches_per_image = 60;
  double nearest_m = 1.2, farthest_m = 4.0;  ///< of the images; within one, z varies by `depth_m`
  double depth_m = 0.3;
  double log_gain_sigma = 0;
  double misread_share = 0;  ///< patches that show another albedo than they should
  double excess_sigma = 0.001;
  int pixels = 40;  ///< of a patch
};

/// The gains that the images were given, and their patches.
struct MadePatches {
  std::vector<Patch> patches;
  std::vector<double> log_gain;  ///< their mean is 0
};

/// Radiance by the paper's equation, written out here a second time.
inline double radianceThrough(double albedo, double z_m, const Environment& e, int c) {
  const double passed = std::exp(-e.water.attenuation_per_m[c] * z_m);
  return albedo * e.ambient[c] * passed + (1 - passed) * e.water.veil[c];
}

inline MadePatches makePatches(const Environment& environment, const PatchPlan& plan, std::uint64_t seed) {
  Random random(seed);
  const CameraSheet sheet;
  MadePatches made;
  double mean = 0;
  for (std::size_t k = 0; k < plan.images; ++k) {
    made.log_gain.push_back(plan.log_gain_sigma * random.normal());
    mean += made.log_gain.back() / static_cast<double>(plan.images);
  }
  for (double& gain : made.log_gain) gain -= mean;
  for (std::size_t k = 0; k < plan.images; ++k) {
    const double share = plan.images > 1 ? static_cast<double>(k) / static_cast<double>(plan.images - 1) : 0;
    const double image_z_m = plan.nearest_m + share * (plan.farthest_m - plan.nearest_m);
    for (std::size_t i = 0; i < plan.patches_per_image; ++i) {
      Patch patch;
      patch.image = k;
      patch.z_m = image_z_m + plan.depth_m * random.uniform(-0.5, 0.5);
      patch.range_m = 1.05 * patch.z_m;
      const double kinds[] = {0.85, 0.04, 0.3};
      patch.albedo = Vector3d::Constant(kinds[i % 3]);
      const bool misread = random.uniform() < plan.misread_share;
      const double shown = kinds[(i + (misread ? 1 : 0)) % 3];
      for (int c = 0; c < 3; ++c) {
        const double clean = std::exp(made.log_gain[k]) * radianceThrough(shown, patch.z_m, environment, c);
        patch.sigma[c] = radianceSigma(clean, sheet) / std::sqrt(plan.pixels);
        patch.radiance[c] = clean + std::hypot(patch.sigma[c], plan.excess_sigma) * random.normal();
      }
      made.patches.push_back(patch);
    }
  }
  return made;
}

}  // namespace fathom::test
