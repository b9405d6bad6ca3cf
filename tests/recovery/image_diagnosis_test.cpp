// Diagnosis with images: black and white of the markers beside navigation and corners.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "effects/drawn.h"
#include "support/diagnosis_score.h"
#include "support/flawed_runs.h"
#include "support/sanitized.h"

namespace fathom {
namespace {

const test::Excitation& lightExcitation() {
  static const test::Excitation excitation(test::lightDive());
  return excitation;
}

// Its water is found beside path and calibration: within 4 of the sigmas that the linearization states.
TEST(ImageDiagnosis, TheWaterIsFound) {
  const BatchInput input = test::lightDive().input();
  const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  const auto problem = problemAt(input.data, estimate, {});
  const UnknownBlock* water = problem->find(UnknownBlock::Kind::water, 0);
  ASSERT_NE(water, nullptr);
  const Nuisances nuisances(linearize(input.data, *problem, false).J);
  std::vector<Eigen::Index> unknowns(9);
  for (Eigen::Index i = 0; i < 9; ++i) unknowns[static_cast<std::size_t>(i)] = water->column + i;
  const Eigen::VectorXd sigma = nuisances.covariance(unknowns).diagonal().cwiseSqrt();
  const Vector9d error = estimate.state.water - test::coastalWater();
  for (Eigen::Index i = 0; i < 9; ++i) EXPECT_LT(std::abs(error[i]), 4 * sigma[i]) << i;
  EXPECT_LT(sigma.maxCoeff(), 0.002);
}

BatchEstimate withOneMore(const BatchInput& input, const BatchEstimate& from, const char* effect) {
  BatchOptions options;
  options.calibration.on.set(findEffect(effect)->index);
  options.problem.estimate.set(findEffect(effect)->index);
  BatchEstimate estimate = minimumFrom(input.data, from, options);
  EXPECT_TRUE(estimate.succeeded) << estimate.failure;
  return estimate;
}

// One more effect on light leaves poses where they are, and ends where it would if all were minimized again;
// one on the DVL moves them, and the water with them, as light is then looked at from elsewhere.
TEST(ImageDiagnosis, OnlyWhatAnEffectTouchesIsEstimatedAgain) {
  test::BatchRun run = test::lightDive();
  run.effects.add<SlantRange>({0.5});
  run.effects.add<DvlScale>({0.02});
  const BatchInput input = run.input();
  const BatchEstimate nominal = estimateBatch(input.data, input.start, {});
  ASSERT_TRUE(nominal.succeeded) << nominal.failure;
  BatchEstimate unknown_before = nominal;
  unknown_before.options.reset();
  const auto positions = [](const BatchEstimate& estimate) {
    std::vector<double> all;
    for (const Pose& pose : estimate.state.path.poses)
      all.insert(all.end(), pose.position.begin(), pose.position.end());
    return all;
  };

  const BatchEstimate slant = withOneMore(input, nominal, "slant-range"),
                      slant_anew = withOneMore(input, unknown_before, "slant-range");
  EXPECT_EQ(positions(slant), positions(nominal));
  EXPECT_NEAR(*slant.state.effects.of<SlantRange>(), *slant_anew.state.effects.of<SlantRange>(), 1e-4);
  EXPECT_NEAR(*slant.state.effects.of<SlantRange>(), 0.5, 0.05);
  EXPECT_LT((slant.state.water - slant_anew.state.water).norm(), 1e-4);

  const BatchEstimate scale = withOneMore(input, nominal, "dvl-scale"),
                      scale_anew = withOneMore(input, unknown_before, "dvl-scale");
  EXPECT_NE(positions(scale), positions(nominal));
  EXPECT_EQ(positions(scale), positions(scale_anew));
  EXPECT_EQ(scale.state.water, scale_anew.state.water);
  EXPECT_NE(scale.state.water, nominal.state.water);
}

TEST(ImageDiagnosis, SaysThatNothingIsMissing) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  const test::Answer answer = test::answerOf(test::plainNull(test::lightDive(), 1), lightExcitation());
  EXPECT_EQ(nameOf(answer.outcome), "none") << test::told(answer);
}

// What tells of a camera's latency is mostly what the gyro would have had to read for markers to be where
// they are: that corners themselves are hardly off is no reason to leave it out. Beside another effect, too.
TEST(ImageDiagnosis, ALatencyIsToldByWhatItAsksOfTheGyro) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  const EffectInfo& late = *findEffect("camera-latency");
  test::DiagnosisRun hidden = test::effectOfSize(test::lightDive(), lightExcitation(), late, 12.0, 1);
  hidden.run.effects.add<DarkOffset>({-0.005});
  const Diagnosis diagnosis = diagnose(hidden.input());
  std::set<std::string> named;
  for (const FoundEffect& effect : diagnosis.effects) named.insert(nameOf(effect.candidate));
  for (const Alternatives& set : diagnosis.alternatives)
    for (const Candidate& other : set.candidates) named.insert(nameOf(other));
  EXPECT_TRUE(named.contains("dark-offset")) << diagnosis.why;
  EXPECT_TRUE(named.contains("camera-latency")) << diagnosis.why;
}

// What the veil's model errs by in another world may be as large as a hundredth of it, and look like
// anything.
TEST(ImageDiagnosis, WhatMayBeAnothersErrorIsARemark) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  const auto ofSize = [](const char* effect, double sqrt_lambda) {
    return test::effectOfSize(test::lightDive(), lightExcitation(), *findEffect(effect), sqrt_lambda, 1);
  };
  test::DiagnosisRun hidden = ofSize("separate-backscatter", 800);
  hidden.run.effects.add<DarkOffset>({*ofSize("dark-offset", 7).run.effects.of<DarkOffset>()});
  const Diagnosis diagnosis = diagnose(hidden.input());
  ASSERT_EQ(diagnosis.effects.size(), 1U) << diagnosis.why;
  EXPECT_EQ(nameOf(diagnosis.effects[0].candidate), "separate-backscatter");
  EXPECT_TRUE(std::any_of(diagnosis.remarks.begin(), diagnosis.remarks.end(), [](const std::string& remark) {
    return remark.starts_with("dark-offset would fit, but it is ");
  })) << diagnosis.why;
}

class HiddenImageEffect : public testing::TestWithParam<const char*> {};
TEST_P(HiddenImageEffect, IsNamed) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  const auto hidden =
      test::effectOfSize(test::lightDive(), lightExcitation(), *findEffect(GetParam()), 24.0, 1);
  const test::Answer answer = test::answerOf(hidden, lightExcitation());
  EXPECT_TRUE(test::namesTheEffect(answer)) << test::told(answer);
}
INSTANTIATE_TEST_SUITE_P(Diagnosis, HiddenImageEffect,
                         testing::Values("separate-backscatter", "slant-range", "lamp", "forward-scatter",
                                         "vignetting", "gamma", "dark-offset", "turbidity-plume",
                                         "motion-blur", "marine-snow", "dvl-latency", "flat-field",
                                         "response-curve", "veiling-glare", "defocus", "biofouling",
                                         "occlusion"));

// Dirt on two places of a panel: no effect is named for it, it is said where, and the other places' prints
// are as even as they were.
TEST(ImageDiagnosis, WhatIsOnSinglePlacesIsSaidWithItsPlace) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  test::DiagnosisRun dive;
  dive.run = test::lightDive();
  dive.change_light = [](std::vector<ImagePatch>& patches) {
    std::set<int> covered;
    for (const ImagePatch& patch : patches)
      if (patch.surface == ImagePatch::Surface::white && covered.size() < 2) covered.insert(patch.place);
    for (ImagePatch& patch : patches)
      if (covered.contains(patch.place)) patch.albedo /= 0.7;  // as the map has it
  };
  const Diagnosis diagnosis = diagnose(dive.input());
  EXPECT_TRUE(diagnosis.effects.empty()) << diagnosis.why;
  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained) << diagnosis.why;
  EXPECT_NE(diagnosis.why.find("print"), std::string::npos) << diagnosis.why;
  EXPECT_NE(diagnosis.why.find("of the panel"), std::string::npos) << diagnosis.why;
  for (const BudgetEntry& entry : diagnosis.budget)
    if (entry.component.starts_with("print-")) EXPECT_LT(entry.estimate, entry.prior) << entry.component;
}

// A number that three images have in common is one, not three.
TEST(ImageDiagnosis, FlakesThatAreSeenAgainTellLess) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: HiddenImageEffect takes the same way there";
  const test::DiagnosisRun dive =
      test::effectOfSize(test::lightDive(), lightExcitation(), *findEffect("marine-snow"), 24.0, 1);
  BatchInput input = dive.input();
  const auto sigma = [&] {
    const Diagnosis diagnosis = diagnose(input);
    for (const FoundEffect& found : diagnosis.effects)
      if (allEffects()[found.candidate.effect].id == "marine-snow") return found.estimates[0].sigma;
    return 0.0;
  };
  const double of_fresh_ones = sigma();
  for (std::size_t i = 0; i < input.data.specks.size(); ++i)
    input.data.specks[i].counted = input.data.specks[i - i % 3].counted;
  EXPECT_GT(of_fresh_ones, 0);
  // The root of three, but for what an autoregression makes of it and chance: some hundred flakes.
  EXPECT_GT(sigma(), 1.4 * of_fresh_ones);
}

/// What this run's images were given of what is drawn for each: by how much it scatters about its mean.
double spreadGiven(const test::BatchRun& run, std::size_t scalar, const std::vector<ImagePatch>& patches) {
  std::map<std::size_t, double> drawn;
  for (const ImagePatch& patch : patches)
    drawn[patch.image] = drawnFor(run.effects, run.seed, patch.t_s).values[scalar];
  double sum = 0, squares = 0;
  for (const auto& [image, value] : drawn) sum += value, squares += value * value;
  const auto count = static_cast<double>(drawn.size());
  return std::sqrt((squares - sum * sum / count) / (count - 1));
}

// All edges alike and to all sides: neither what is forward scattered, which grows with range, nor what
// moves.
template <class Effect>
void expectToldFromWaterAndMotion(double amount) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  test::DiagnosisRun hidden = test::plainNull(test::lightDive(), 1);
  hidden.run.effects.add<Effect>({amount});
  const Diagnosis diagnosis = diagnose(hidden.input());
  ASSERT_EQ(diagnosis.effects.size(), 1U) << diagnosis.why;
  EXPECT_EQ(nameOf(diagnosis.effects[0].candidate), Effect::id);
  const EffectEstimate& found = diagnosis.effects[0].estimates.at(0);
  EXPECT_NEAR(found.value, amount, 3 * found.sigma);
}
TEST(ImageDiagnosis, ALensOutOfFocusIsTold) { expectToldFromWaterAndMotion<Defocus>(1.0); }

// What edges show of it saturates, and lenses may be as much better than stated: it is said, if not named.
TEST(ImageDiagnosis, ASharpenedImageIsSaid) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  test::DiagnosisRun hidden = test::plainNull(test::lightDive(), 1);
  hidden.run.effects.add<Sharpening>({1.5});
  const Diagnosis diagnosis = diagnose(hidden.input());
  EXPECT_TRUE(diagnosis.effects.empty() || nameOf(diagnosis.effects[0].candidate) == "sharpening")
      << diagnosis.why;
  EXPECT_NE(diagnosis.why.find("sharpening"), std::string::npos) << diagnosis.why;
}

/// What changes no patch: it is told by the noise of plain surfaces.
template <class Effect>
void expectToldByNoise(double amount) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  test::DiagnosisRun hidden = test::plainNull(test::lightDive(), 1);
  hidden.run.effects.add<Effect>({amount});
  const Diagnosis diagnosis = diagnose(hidden.input());
  ASSERT_EQ(diagnosis.effects.size(), 1U) << diagnosis.why;
  EXPECT_EQ(nameOf(diagnosis.effects[0].candidate), Effect::id);
  const EffectEstimate& found = diagnosis.effects[0].estimates.at(0);
  EXPECT_NEAR(found.value, amount, 3 * found.sigma);
  EXPECT_LT(found.sigma, 0.1);
}
TEST(ImageDiagnosis, InterpolatedColoursAreTold) { expectToldByNoise<Demosaicing>(0.7); }
TEST(ImageDiagnosis, CompressionIsTold) { expectToldByNoise<ImageCompression>(0.3); }

// An ordinary camera does both, and more: no mismatch.
TEST(ImageDiagnosis, AProcessedCameraMayDoBoth) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  test::DiagnosisRun ordinary = test::plainNull(test::lightDive(), 1);
  ordinary.run.vehicle.camera->pipeline = CameraPipeline::processed;
  ordinary.run.effects.add<Demosaicing>({1.0});
  ordinary.run.effects.add<ImageCompression>({0.3});
  const Diagnosis diagnosis = diagnose(ordinary.input());
  EXPECT_TRUE(diagnosis.effects.empty()) << diagnosis.why;
}

/// What is drawn anew for each image: by how much it scatters, over some two dozen of them.
class HiddenDrawnEffect : public testing::TestWithParam<const char*> {};
TEST_P(HiddenDrawnEffect, IsNamed) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  constexpr double kSpread = 0.05;
  const EffectInfo& effect = *findEffect(GetParam());
  test::DiagnosisRun hidden = test::plainNull(test::lightDive(), 1);
  hidden.truth = Candidate{.effect = effect.index};
  hidden.run.effects.on.set(effect.index);
  std::vector<std::size_t> scalars;
  for (const Parameter& parameter : effect.parameters)
    for (int k = 0; k < parameter.size; ++k) scalars.push_back(effect.first_scalar + scalars.size());
  for (const std::size_t scalar : scalars) hidden.run.effects.values[scalar] = kSpread;
  const BatchInput input = hidden.input();
  const Diagnosis diagnosis = diagnose(input);
  const test::Answer answer = test::score(diagnosis, hidden, lightExcitation());
  ASSERT_EQ(diagnosis.effects.size(), 1U) << test::told(answer);
  EXPECT_EQ(diagnosis.effects[0].candidate.effect, effect.index) << test::told(answer);
  // What shows in every image is not what noise is.
  EXPECT_NEAR(diagnosis.noise.channels[indexOf(kChannel<Pixels>)].independentScale(), 1, 0.15);
  // It is what those images were given, about their mean.
  ASSERT_EQ(diagnosis.effects[0].estimates.size(), scalars.size());
  for (const EffectEstimate& found : diagnosis.effects[0].estimates) {
    EXPECT_NEAR(found.value, spreadGiven(hidden.run, found.scalar, input.data.patches), 0.03 * kSpread);
    EXPECT_NEAR(found.value, kSpread, 3 * found.sigma);
    std::map<std::size_t, double> off;
    double mean = 0;
    for (const ImagePatch& patch : input.data.patches) {
      const double value = diagnosis.after.state.draws.at({found.scalar, patch.image});
      const auto truth = drawnFor(hidden.run.effects, hidden.run.seed, patch.t_s);
      off[patch.image] = value - truth.values[found.scalar];
    }
    for (const auto& [image, error] : off) mean += error / static_cast<double>(off.size());
    for (const auto& [image, error] : off) EXPECT_NEAR(error, mean, 0.003) << image;
    EXPECT_LT(std::abs(mean), 4 * kSpread / std::sqrt(static_cast<double>(off.size())));
  }
}
INSTANTIATE_TEST_SUITE_P(Diagnosis, HiddenDrawnEffect,
                         testing::Values("auto-exposure", "sun-flicker", "white-balance"));

// Held-out images tell their own draws, beside gains of their own that the budget allows for. With a prior
// far wider than what was drawn they would tell these gains, and nothing would be gained there.
TEST(ImageDiagnosis, AFlickerLessThanTheGainsIsNamed) {
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the test of the water takes the same way through the model";
  const EffectInfo& effect = *findEffect("sun-flicker");
  test::DiagnosisRun hidden = test::plainNull(test::lightDive(), 1);
  hidden.run.effects.on.set(effect.index);
  hidden.run.effects.values[effect.first_scalar] = 0.001;
  hidden.change_light = [](std::vector<ImagePatch>& patches) {
    for (ImagePatch& patch : patches)
      patch.radiance *= std::exp(0.003 * Random::stream(5, patch.image).normal());
  };
  const BatchInput input = hidden.input();
  const Diagnosis diagnosis = diagnose(input);
  ASSERT_EQ(diagnosis.effects.size(), 1U) << diagnosis.why;
  EXPECT_EQ(diagnosis.effects[0].candidate.effect, effect.index) << diagnosis.why;
  const EffectEstimate& found = diagnosis.effects[0].estimates.at(0);
  EXPECT_NEAR(found.value, spreadGiven(hidden.run, effect.first_scalar, input.data.patches), 3 * found.sigma);
}

}  // namespace
}  // namespace fathom
