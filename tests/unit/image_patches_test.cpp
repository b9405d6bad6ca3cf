// Patches of images: with every effect on light, what they should read is what the image has.
#include "environment/image_patches.h"

#include <gtest/gtest.h>

#include "effects/catalogue.h"
#include "effects/drawn.h"
#include "sensors/image_patch.h"
#include "support/sil_recordings.h"

namespace fathom {
namespace {

/// Alone, half as large as one would expect; a peak is wide and near.
EffectParameters<double> withOnly(const EffectInfo& effect) {
  EffectParameters<double> effects;
  effects.on.set(effect.index);
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& p : effect.parameters)
    for (int i = 0; i < p.size; ++i, ++scalar)
      if (isSize(p.kind)) effects.values[scalar] = 0.5 * p.prior_sigma;
  return effects;
}

struct Seen {
  std::vector<ImagePatch> patches;
  std::vector<PosedImage> posed;
};

/// Images of the shipped panel, cut by the nominal model at the true poses. With the sensor's noise: without,
/// all of a patch is rounded alike.
Seen seenWith(const EffectParameters<double>& effects) {
  const auto recording = test::simulateForSil(test::scratchFolder(), {.images = 3, .effects = effects});
  const PosedImages images = test::atTruth(
      posedImages(recording.rawlog, readPanelMaps(test::kDexrovMap), test::silDetection()), recording.rawlog);
  const PairMaker maker(test::silWorld(), {}, test::silDetection());
  const Time time_zero = RawlogReader(recording.rawlog).next()->time;
  return {imagePatches(images.posed, maker, time_zero).patches, images.posed};
}

class PatchesWithEffect : public testing::TestWithParam<std::size_t> {};

// In units of the sigma that a patch states, the mean square is at most one: it counts rounding and panels
// that are not quite flat too, which these are.
TEST_P(PatchesWithEffect, ReadWhatTheImageHas) {
  const EffectInfo& effect = allEffects()[GetParam()];
  const EffectParameters<double> effects = withOnly(effect);
  const SilWorld world = test::silWorld();
  const Vector9d water = waterParameters(world.environment);
  const Seen seen = seenWith(effects);
  ASSERT_GT(seen.patches.size(), 30U);
  double error = 0, change = 0, count = 0;
  for (const ImagePatch& patch : seen.patches) {
    const PosedImage& posed = seen.posed.at(patch.image);
    KinematicState<double> state;
    state.position_odom = posed.T_odom_robot.pose.position;
    state.R_odom_robot = posed.T_odom_robot.pose.rotation;
    const auto panel = nominalPlacement<double>(world.panels[patch.panel].T_odom_panel, patch.t_s);
    const auto with = [&](const EffectParameters<double>& these) {
      return predictPatch(state, panel, patch, world.vehicle.lamps, water, these, patch.t_s);
    };
    const Vector3d right = with(drawnFor(effects, SimulationOptions{}.seed, patch.t_s)), nominal = with({});
    for (const int colour : patch.colours()) {
      error += std::pow((right[colour] - patch.radiance[colour]) / patch.sigma[colour], 2);
      change += std::pow((nominal[colour] - patch.radiance[colour]) / patch.sigma[colour], 2);
      ++count;
    }
  }
  EXPECT_LT(error / count, 1) << effect.id;
  EXPECT_GT(change / count, 3) << effect.id;
}

std::vector<std::size_t> lightEffects() {
  std::vector<std::size_t> effects;
  for (const EffectInfo& effect : allEffects())
    if (effect.text.channel == EffectChannel::image) effects.push_back(effect.index);
  return effects;
}
INSTANTIATE_TEST_SUITE_P(ImagePatches, PatchesWithEffect, testing::ValuesIn(lightEffects()),
                         [](const auto& info) {
                           std::string name(allEffects()[info.param].id);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace fathom
