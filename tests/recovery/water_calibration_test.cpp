// Recordings whose light, lens or response is other than the base model has it: told of that, task T_E finds
// the water and task T_P the errors to be expected; without, they do not.
#include <gtest/gtest.h>

#include "environment/water_study.h"
#include "support/shared_data.h"
#include "support/water_recordings.h"

namespace fathom {
namespace {

const char* const kWater = "water_moderate.yaml";

/// What T_E makes of a recording when it is told of `known`: twelve images fitted, four held out, and as good
/// as no search, which takes long.
WaterStudy studied(const RecordingFiles& recording, const EffectParameters<double>& known) {
  KnownWorld world = test::silWorld();
  world.effects = known;
  const PosedImages images =
      posedImages(recording.rawlog, {}, world.panels, test::silDetection(), world.effects);
  WaterStudyOptions options;
  options.choice.images = 12;
  options.choice.held_out = 4;
  options.fit.start = readEnvironment(test::kConfig / "water_clear.yaml");
  options.search.evaluations = options.search_images = 1;
  return studyWater(recording.rawlog, images, PairMaker(world, {}, test::silDetection()), options);
}

Vector3d attenuationErrors(const WaterStudy& study) {
  return study.fit.environment.water.attenuation_per_m -
         readEnvironment(test::kConfig / kWater).water.attenuation_per_m;
}

double heldOutRmse(const WaterStudy& study) { return meanScore(study.candidates[2], &WaterScore::rmse).mean; }

/// `farther`: by how much farther from truth attenuation is without, at least.
void expectTold(const EffectParameters<double>& effects, double farther) {
  const auto recording = test::simulateApproach(test::scratchFolder(), kWater, 1, 24, effects);
  const WaterStudy with = studied(recording, effects), without = studied(recording, {});
  const Vector3d sigma = with.fit.sigma().head<3>();
  for (int c = 0; c < 3; ++c) EXPECT_LT(std::abs(attenuationErrors(with)[c]), 4 * sigma[c]) << c;
  EXPECT_GT(attenuationErrors(without).norm(), farther * attenuationErrors(with).norm());
  EXPECT_LT(heldOutRmse(with), 0.7 * heldOutRmse(without));
  EXPECT_EQ(with.recommendedWater().name, "fitted");
}

// The lens fogs up in the middle of the recording.
TEST(WaterCalibration, OfALensAndAVeil) {
  EffectParameters<double> effects;
  effects.add<Vignetting>({0.5, 0.0});
  effects.active_s[kEffectIndex<Vignetting>] = {12, 60};
  effects.add<SeparateBackscatter>({0.15, 0.1, 0.08});
  expectTold(effects, 5);
}

TEST(WaterCalibration, OfAResponseAndSlantRays) {
  EffectParameters<double> effects;
  effects.add<Gamma>({-0.3});
  effects.add<SlantRange>({1.0});
  expectTold(effects, 5);
}

TEST(WaterCalibration, OfLamps) {
  EffectParameters<double> effects;
  effects.add<Lamp>({1.0});
  expectTold(effects, 5);
}

TEST(WaterCalibration, OfLightThatIsBent) {
  EffectParameters<double> effects;
  effects.add<ForwardScatter>({0.4});
  expectTold(effects, 2);
}

// T_P: estimators that know nothing of a lens err as much as is expected of it.
TEST(WaterCalibration, TellsThePoseErrorsOfALens) {
  EffectParameters<double> effects;
  effects.add<FocalScale>({0.03});
  const auto recording = test::simulateApproach(test::scratchFolder(), kWater, 1, 24, effects);
  const auto position = &PanelPoseError::position_m;
  const PanelPoseCheck with = studied(recording, effects).panel_poses.value(),
                       without = studied(recording, {}).panel_poses.value();
  EXPECT_TRUE(agree(with.joint(with.expected, position), with.joint(with.measured, position)));
  EXPECT_FALSE(agree(without.joint(without.expected, position), without.joint(without.measured, position)));
}

}  // namespace
}  // namespace fathom
