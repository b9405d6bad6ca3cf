// Patches, edges, specks and noise of images: with every effect on light, what they should read is what the
// image has.
#include "observables/image_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/linear_algebra.h"
#include "effects/catalogue.h"
#include "effects/drawn.h"
#include "effects/image_regions.h"
#include "environment/water_fit.h"
#include "imaging/exposure_time.h"
#include "imaging/image_patch.h"
#include "imaging/image_texture.h"
#include "imaging/marine_snow.h"
#include "imaging/marker_blur.h"
#include "support/shared_data.h"
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
  std::vector<MarkerBlur> blurs;
  std::vector<ImageSpecks> specks;
  std::vector<ImageTexture> textures;
  std::vector<PosedImage> posed;
};

/// Images of the shipped panel, cut by the nominal model at the true poses. With the sensor's noise: without,
/// all of a patch is rounded alike.
Seen seenWith(const EffectParameters<double>& effects, double exposure_s = 0.004) {
  const auto recording = test::simulateForSil(test::scratchFolder(),
                                              {.images = 3, .effects = effects, .exposure_s = exposure_s});
  const PosedImages images =
      test::atTruth(posedImages(recording.rawlog, {}, readPanelMaps(test::kDexrovMap), test::silDetection()),
                    recording.rawlog);
  KnownWorld world = test::silWorld();
  world.vehicle.camera->exposure_s = exposure_s;
  const CleanPairMaker maker(world);
  const Time time_zero = RawlogReader(recording.rawlog).next()->time;
  ImagePatches found = imagePatches(images.posed, maker, time_zero, startWater);
  return {std::move(found.patches), std::move(found.blurs), std::move(found.specks),
          std::move(found.textures), images.posed};
}

KinematicState<double> stateOf(const PosedImage& posed) {
  KinematicState<double> state;
  state.position_odom = posed.T_odom_robot.pose.position;
  state.R_odom_robot = posed.T_odom_robot.pose.rotation;
  return state;
}

class PatchesWithEffect : public testing::TestWithParam<std::size_t> {};

/// Of the markers, the one of which most patches are seen.
int seenMarker() {
  std::map<int, int> patches;
  for (const ImagePatch& patch : seenWith({}).patches)
    if (patch.marker_id >= 0) ++patches[patch.marker_id];
  return std::max_element(patches.begin(), patches.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

// In units of the sigma that a patch states, the mean square is at most one: it counts what rounding may do.
TEST_P(PatchesWithEffect, ReadWhatTheImageHas) {
  const EffectInfo& effect = allEffects()[GetParam()];
  EffectParameters<double> effects = withOnly(effect);
  if (effect.has(ParameterKind::marker_id)) effects.values[effect.first_scalar] = seenMarker();
  const KnownWorld world = test::silWorld();
  const Vector9d water = waterParameters(world.environment);
  const Seen seen = seenWith(effects);
  ASSERT_GT(seen.patches.size(), 30U);
  EXPECT_TRUE(std::any_of(seen.patches.begin(), seen.patches.end(), [](const ImagePatch& patch) {
    return patch.surface == ImagePatch::Surface::water;
  }));
  double error = 0, change = 0, count = 0, changed = 0;  // some effects are of one marker alone
  for (const ImagePatch& patch : seen.patches) {
    // How much of a patch is beyond a region's border depends on its outline, of which only moments are
    // known.
    const double in_region = kImageRegions[0].shareOf(patch.image_place, patch.image_spread);
    if (effect.has(ParameterKind::region) && in_region > 0 && in_region < 1) continue;
    const PosedImage& posed = seen.posed.at(patch.image);
    const KinematicState<double> state = stateOf(posed);
    const auto panel = nominalPlacement<double>(world.panels[patch.panel].T_odom_panel, patch.t_s);
    const auto with = [&](const EffectParameters<double>& these) {
      return predictPatch(state, panel, patch, world.vehicle.lamps, water, these, patch.t_s);
    };
    const Vector3d right = with(drawnFor(effects, SimulationOptions{}.seed, patch.t_s)), nominal = with({});
    for (const int colour : patch.colours()) {
      error += std::pow((right[colour] - patch.radiance[colour]) / patch.sigma[colour], 2);
      change += std::pow((nominal[colour] - patch.radiance[colour]) / patch.sigma[colour], 2);
      ++count;
      if (right[colour] != nominal[colour]) ++changed;
    }
  }
  EXPECT_LT(error / count, 1) << effect.id;
  EXPECT_GT(changed, 5) << effect.id;
  EXPECT_GT(change / changed, 3) << effect.id;
}

// What is seen of one paint and what of another beside it would vary from image to image.
TEST(ImagePatches, AreOfOnePaint) {
  const KnownWorld world = test::silWorld();
  const Surface& body = world.panels[0].body;
  const Seen seen = seenWith({});
  std::size_t of_body = 0;
  for (const ImagePatch& patch : seen.patches) {
    if (patch.surface != ImagePatch::Surface::body) continue;
    ++of_body;
    EXPECT_TRUE(std::any_of(body.vertices.begin(), body.vertices.end(), [&](const auto& vertex) {
      return (vertex.albedo.template cast<double>() - patch.albedo).norm() < 1e-3;
    })) << patch.albedo.transpose();
  }
  EXPECT_GT(of_body, 20U);
}

// By how much a patch's pixels scatter is how much its places on the panel do, projected: to 2 %, by which a
// lens is no straight line over a patch.
TEST(ImagePatches, SpreadInTheImageAsOnThePanel) {
  const KnownWorld world = test::silWorld();
  const Seen seen = seenWith({});
  std::size_t of_panel = 0;
  for (const ImagePatch& patch : seen.patches) {
    if (patch.surface == ImagePatch::Surface::water) continue;
    ++of_panel;
    const PosedImage& posed = seen.posed.at(patch.image);
    const Pose T_camera_panel = posed.T_odom_camera().inverse() * world.panels[patch.panel].T_odom_panel;
    Vector2d squares = Vector2d::Zero();
    for (const Vector3d& point : patch.around_panel)
      squares += 0.25 * (posed.camera.lens.project<double>(T_camera_panel * point) - patch.pixel).cwiseAbs2();
    EXPECT_LT((squares.cwiseSqrt() - patch.pixel_spread).norm(), 0.02 * patch.pixel_spread.norm());
  }
  EXPECT_GT(of_panel, 30U);
}

/// By the stage that an effect acts at it is seen in edges, as specks, in noise, or else in patches.
template <class Stage>
bool actsAt(std::size_t effect) {
  EffectParameters<double> alone;
  alone.on.set(effect);
  return anyActsAt<Stage>(alone);
}
bool smears(std::size_t effect) { return actsAt<ExposureTime<double>>(effect); }
bool showsInEdges(std::size_t effect) { return smears(effect) || actsAt<ImageSoftness<double>>(effect); }
bool showsAsSpecks(std::size_t effect) { return actsAt<SuspendedParticles<double>>(effect); }
bool showsInNoise(std::size_t effect) { return actsAt<ImageCoding<double>>(effect); }
bool showsInPatches(std::size_t effect) {
  return !showsInEdges(effect) && !showsAsSpecks(effect) && !showsInNoise(effect);
}

std::vector<std::size_t> lightEffects() {
  std::vector<std::size_t> effects;
  for (const EffectInfo& effect : allEffects())
    if (effect.text.channel == EffectChannel::image) effects.push_back(effect.index);
  return effects;
}
std::vector<std::size_t> effectsInPatches() {
  std::vector<std::size_t> effects = lightEffects();
  std::erase_if(effects, [](std::size_t effect) { return !showsInPatches(effect); });
  return effects;
}
std::string nameOfTest(const testing::TestParamInfo<std::size_t>& info) {
  std::string name(allEffects()[info.param].id);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(ImagePatches, PatchesWithEffect, testing::ValuesIn(effectsInPatches()), nameOfTest);

/// Mean square of how far edges are from as soft as predicted with these effects, in units of their sigmas.
double softnessError(const Seen& seen, const EffectParameters<double>& effects) {
  const KnownWorld world = test::silWorld();
  const Trajectory path = test::silPath();
  double sum = 0;
  for (const MarkerBlur& blur : seen.blurs) {
    const auto panel = nominalPlacement<double>(world.panels[blur.panel].T_odom_panel, blur.t_s);
    const KinematicState<double> state = path.at(test::kSilBegin_s + blur.t_s);
    const Vector3d off = blur.variance_px2 - predictBlur(state, panel, blur, 0.0,
                                                         beyondStated(effects, blur.exposure_s), blur.t_s);
    sum += normalizedSquare(blur.covariance_px4, off) / 3;
  }
  return sum / static_cast<double>(seen.blurs.size());
}

class EdgesWithEffect : public testing::TestWithParam<std::size_t> {};

// Whatever else is done to light, edges are as soft as rendered, but for what smears them: by so many of
// their own sigmas. The mean square is of some dozens, whose shapes are the panel's: up to two.
TEST_P(EdgesWithEffect, AreAsSoftAsPredicted) {
  const EffectInfo& effect = allEffects()[GetParam()];
  EffectParameters<double> effects = withOnly(effect);
  if (showsInEdges(effect.index))
    effects.values[effect.first_scalar] = smears(effect.index)         ? 0.1 * 0.1
                                          : showsInNoise(effect.index) ? 1
                                                                       : 0.5;
  const Seen seen = seenWith(effects);
  ASSERT_GT(seen.blurs.size(), 15U);
  EXPECT_LT(softnessError(seen, effects), 2) << effect.id;
  if (showsInEdges(effect.index)) {
    EXPECT_GT(softnessError(seen, {}), 10) << effect.id;
  }
}
INSTANTIATE_TEST_SUITE_P(ImagePatches, EdgesWithEffect, testing::ValuesIn(lightEffects()), nameOfTest);

// The nominal model smears what moves by the exposure that the vehicle file states.
TEST(ImagePatches, EdgesAreAsSoftAsTheStatedExposureMakesThem) {
  Seen seen = seenWith({}, 0.1);
  ASSERT_GT(seen.blurs.size(), 15U);
  EXPECT_LT(softnessError(seen, {}), 2);
  for (MarkerBlur& blur : seen.blurs) blur.exposure_s = 0;
  EXPECT_GT(softnessError(seen, {}), 10);
}

class SpecksWithEffect : public testing::TestWithParam<std::size_t> {};

// Only what drifts in the water makes specks: as many as the volumes say, by Poisson's law.
TEST_P(SpecksWithEffect, AreAsManyAsPredicted) {
  const EffectInfo& effect = allEffects()[GetParam()];
  EffectParameters<double> effects = withOnly(effect);
  if (showsAsSpecks(effect.index)) effects.values[effect.first_scalar] = 500;
  BySpeckClass counted = BySpeckClass::Zero(), expected = BySpeckClass::Zero();
  for (const ImageSpecks& specks : seenWith(effects).specks) {
    counted += specks.counted;
    expected += predictSpecks(specks.volumes, effects, specks.t_s);
    EXPECT_GT(specks.volumes.visible_m3.sum(), 0.01);
  }
  if (!showsAsSpecks(effect.index)) {
    EXPECT_LE(counted.sum(), 1) << effect.id;
    EXPECT_EQ(expected.sum(), 0) << effect.id;
    return;
  }
  EXPECT_GT(expected.sum(), 10);
  for (int k = 0; k < kSpeckClasses; ++k)
    EXPECT_NEAR(counted[k], expected[k], 4 * std::sqrt(1 + expected[k])) << effect.id << " " << k;
}
/// Compression leaves rims at edges, which may be counted: see countSpecks().
std::vector<std::size_t> effectsBesideSpecks() {
  std::vector<std::size_t> effects = lightEffects();
  std::erase(effects, kEffectIndex<ImageCompression>);
  return effects;
}
INSTANTIATE_TEST_SUITE_P(ImagePatches, SpecksWithEffect, testing::ValuesIn(effectsBesideSpecks()),
                         nameOfTest);

class NoiseWithEffect : public testing::TestWithParam<std::size_t> {};

// Only interpolated colours and compression show in it. The forward model takes noise and slopes as normal:
// ratios are right to 10 % (chessboard) and 25 % (blocks: some points of quality).
TEST_P(NoiseWithEffect, IsAsPredicted) {
  const EffectInfo& effect = allEffects()[GetParam()];
  EffectParameters<double> effects = withOnly(effect);
  if (showsInNoise(effect.index))
    effects.values[effect.first_scalar] = effect.index == kEffectIndex<Demosaicing> ? 1 : 0.3;
  const std::vector<ImageTexture> textures = seenWith(effects).textures;
  ASSERT_EQ(textures.size(), 3U);
  Eigen::Vector2d read = Eigen::Vector2d::Zero(), expected = read, variance = read;
  for (const ImageTexture& texture : textures) {
    read += texture.log_ratio / 3;
    expected += predictTexture(texture.noise, effects, texture.t_s) / 3;
    variance += texture.sigma.cwiseAbs2() / 9;
  }
  if (!showsInNoise(effect.index)) {
    EXPECT_EQ(expected.norm(), 0) << effect.id;
  }
  const Eigen::Vector2d tolerance =
      showsInNoise(effect.index) ? Eigen::Vector2d(0.1, 0.25) : Eigen::Vector2d(0, 0);
  for (int k = 0; k < 2; ++k)
    EXPECT_NEAR(read[k], expected[k], tolerance[k] + 4 * std::sqrt(variance[k])) << effect.id << " " << k;
  EXPECT_EQ(expected.maxCoeff() > 0.3, showsInNoise(effect.index)) << effect.id;
}
INSTANTIATE_TEST_SUITE_P(ImagePatches, NoiseWithEffect, testing::ValuesIn(lightEffects()), nameOfTest);

}  // namespace
}  // namespace fathom
