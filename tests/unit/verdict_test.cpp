// The verdict by what was found and what is left beside it.
#include "diagnosis/verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/budget_file.h"
#include "effects/registry.h"

namespace fathom {
namespace {

/// An effect that takes 1000 of log likelihood away, and a map by which so much is left besides.
Diagnosis found(double left) {
  Diagnosis diagnosis;
  FoundEffect effect;
  effect.candidate.effect = kEffectIndex<DvlScale>;
  effect.heldout_log_likelihood_gain = 1000;
  effect.sqrt_lambda = 45;
  diagnosis.effects.push_back(effect);
  diagnosis.heldout.gain.physics = 1000;
  diagnosis.log_odds = 990;
  diagnosis.log_likelihood_gain = 1000;
  Mismatch map;
  map.channel = kChannel<Dvl>;
  map.statistic = "mean residual";
  map.against = "speed";
  map.dof = 6;
  map.statistic_value = 6 + 2 * left;
  map.log_p = -left;
  map.material = true;
  diagnosis.remaining.push_back(map);
  diagnosis.noise.budget = fieldBudget().of(CameraPipeline::linear);
  for (const VarianceComponent& component : diagnosis.noise.budget.components)
    diagnosis.noise.scales.push_back({component.sigma, 0.1});
  return diagnosis;
}

Diagnosis judged(Diagnosis diagnosis) {
  judge(diagnosis, {});
  return diagnosis;
}

TEST(Verdict, IsExplainedWhereLittleIsLeft) {
  const Diagnosis diagnosis = judged(found(30));
  EXPECT_EQ(diagnosis.verdict, Verdict::explained);
  EXPECT_NEAR(diagnosis.remainder.share, 30.0 / 1030, 1e-9);
  EXPECT_NEAR(diagnosis.effects[0].share, 1000.0 / 1030, 1e-9);
  ASSERT_FALSE(diagnosis.remarks.empty());
  EXPECT_NE(diagnosis.remarks.back().find("remains"), std::string::npos) << diagnosis.remarks.back();
}

TEST(Verdict, IsUnexplainedWhereMoreIsLeftAndStillSaysWhatWasFound) {
  const Diagnosis diagnosis = judged(found(80));
  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  ASSERT_EQ(diagnosis.effects.size(), 1u);
  EXPECT_NEAR(diagnosis.effects[0].share, 1000.0 / 1080, 1e-9);
  EXPECT_NE(diagnosis.why.find("dvl-scale"), std::string::npos) << diagnosis.why;
  EXPECT_NE(diagnosis.why.find("against speed"), std::string::npos) << diagnosis.why;
}

TEST(Verdict, WhatHeldOutStretchesGainInSumIsNoMoreThanAllOfIt) {
  Diagnosis diagnosis = found(80);
  diagnosis.heldout.gain.physics = 2000;
  EXPECT_NEAR(judged(std::move(diagnosis)).remainder.share, 80.0 / 1080, 1e-9);
}

TEST(Verdict, WhatIsNamedMayImitateWhatIsLeft) {
  const auto judgedWith = [](double left, bool acts) {
    Diagnosis diagnosis = found(left);
    diagnosis.effects[0].confidence = 0.999;
    Linearization nominal;
    nominal.rows.resize(1);
    nominal.rows[0].channel = acts ? kChannel<Dvl> : kChannel<Depth>;
    nominal.columns.push_back({kEffectIndex<DvlScale>, 0, "", 1, false, false});
    nominal.residual = Eigen::VectorXd::Zero(1);
    nominal.C = Eigen::MatrixXd::Ones(1, 1);
    judge(diagnosis, nominal);
    return diagnosis;
  };
  const auto confidence = [&](double left, bool acts) {
    return judgedWith(left, acts).effects[0].confidence;
  };
  EXPECT_EQ(judgedWith(3000, true).why.find("Something else is missing than"), 0);
  EXPECT_EQ(judgedWith(80, true).why.find("The model leaves out"), 0);
  EXPECT_NEAR(confidence(3000, true), 0.25, 1e-3);
  EXPECT_NEAR(confidence(80, true), 1000.0 / 1080, 1e-2);
  EXPECT_EQ(confidence(3000, false), 0.999) << "of another sensor";
  EXPECT_EQ(confidence(30, true), 0.999) << "explained";
}

TEST(Verdict, WhatIsImmaterialIsNoRemainder) {
  Diagnosis diagnosis = found(80);
  diagnosis.remaining[0].material = false;
  diagnosis = judged(std::move(diagnosis));
  EXPECT_EQ(diagnosis.verdict, Verdict::explained);
  EXPECT_EQ(diagnosis.remainder.share, 0);
}

/// The first component is beyond what is ordinary, which makes the readings so much likelier.
Diagnosis burst(double beyond) {
  Diagnosis diagnosis = found(0);
  const VarianceComponent& component = diagnosis.noise.budget.components[0];
  diagnosis.noise.scales[0] = {1.5 * component.factor * component.sigma, 0.1, beyond};
  return judged(std::move(diagnosis));
}

TEST(Verdict, ABudgetThatBurstsIsAMismatchWithAPlace) {
  const Diagnosis diagnosis = burst(80);
  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  EXPECT_TRUE(diagnosis.budget[0].bursts);
  EXPECT_NEAR(diagnosis.remainder.share, 80.0 / 1080, 1e-9);
  EXPECT_NE(diagnosis.why.find(diagnosis.budget[0].component), std::string::npos) << diagnosis.why;
}

// As of a field that is rougher than it should be: a large scale of small values.
TEST(Verdict, ABudgetThatAmountsToNoMoreThanItsLimitDoesNotBurst) {
  for (const double amount : {0.9, 1.1}) {
    Diagnosis diagnosis = found(0);
    const VarianceComponent& component = diagnosis.noise.budget.components[0];
    const double limit = component.factor * component.sigma;
    diagnosis.noise.scales[0] = {1.5 * limit, 0.1, 80, amount * limit};
    EXPECT_EQ(judged(std::move(diagnosis)).budget[0].bursts, amount > 1);
  }
}

// Growth on one marker, 0.6 where prints differ by 0.02: said where, and the others are as ordinary as
// before.
TEST(Verdict, WhoIsApartIsAMismatchWithAPlace) {
  Diagnosis diagnosis = found(0);
  const auto& components = diagnosis.noise.budget.components;
  const auto of_markers = std::find_if(components.begin(), components.end(), [](const auto& component) {
    return component.each == VarianceComponent::Each::marker;
  });
  ASSERT_NE(of_markers, components.end());
  diagnosis.noise.apart.resize(components.size());
  diagnosis.noise.apart[static_cast<std::size_t>(of_markers - components.begin())] = {
      {{583, 0}, 100 * of_markers->sigma}};
  diagnosis = judged(std::move(diagnosis));
  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  EXPECT_NE(diagnosis.why.find(of_markers->name), std::string::npos) << diagnosis.why;
  EXPECT_NE(diagnosis.why.find("marker 583"), std::string::npos) << diagnosis.why;
  EXPECT_NE(diagnosis.remainder.where.find("marker 583"), std::string::npos);
}

TEST(Verdict, ABudgetThatBurstsByLittleIsARemark) {
  const Diagnosis diagnosis = burst(30);
  EXPECT_EQ(diagnosis.verdict, Verdict::explained);
  EXPECT_TRUE(diagnosis.budget[0].bursts);
  ASSERT_FALSE(diagnosis.remarks.empty());
  EXPECT_NE(diagnosis.remarks.back().find(diagnosis.budget[0].component), std::string::npos);
  // What chance does is no burst at all.
  EXPECT_FALSE(burst(2).budget[0].bursts);
}

// A recording without a camera says nothing of a panel's print.
TEST(Verdict, WhatNoReadingTellsOfIsNoEntryOfTheBudget) {
  Diagnosis diagnosis = found(0);
  const std::size_t all = judged(diagnosis).budget.size();
  diagnosis.noise.scales[0].amount = 0;
  diagnosis = judged(std::move(diagnosis));
  EXPECT_EQ(diagnosis.budget.size(), all - 1);
  EXPECT_NE(diagnosis.budget[0].component, diagnosis.noise.budget.components[0].name);
}

TEST(Verdict, WithoutAnEffectABurstIsAllThatIsLeft) {
  Diagnosis diagnosis = found(0);
  diagnosis.effects.clear();
  diagnosis.heldout.gain.physics = 0;
  diagnosis.noise.channels[indexOf(kChannel<Dvl>)].rows = 200;
  diagnosis.noise.channels[indexOf(kChannel<Dvl>)].scale = 1.3 * diagnosis.noise.budget.noise_factor;
  diagnosis = judged(std::move(diagnosis));
  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  EXPECT_EQ(diagnosis.remainder.share, 1);
  EXPECT_NE(diagnosis.why.find("noise of dvl"), std::string::npos) << diagnosis.why;
}

// "Nothing material is missing: … would be seen by chance with probability 2e-26" contradicted itself.
TEST(Verdict, WhatChanceDoesNotGiveIsNotNothing) {
  Diagnosis diagnosis = found(0);
  diagnosis.effects.clear();
  diagnosis.remaining.clear();
  diagnosis.heldout = {};
  diagnosis.log_odds = diagnosis.log_likelihood_gain = 0;
  diagnosis.most_improbable = "water-current";
  diagnosis.alarm_p = 0.01;
  EXPECT_NE(judged(diagnosis).verdict, Verdict::unexplained);
  diagnosis.alarm_p = 1e-15;
  const Diagnosis told = judged(diagnosis);
  EXPECT_EQ(told.verdict, Verdict::unexplained);
  EXPECT_NE(told.why.find("water-current"), std::string::npos) << told.why;
  EXPECT_EQ(told.remainder.share, 1);
  EXPECT_TRUE(told.remainder.material);
  ASSERT_FALSE(told.posterior.empty());
  EXPECT_TRUE(told.posterior.front().is_something_else);
}

// One in ten pixels is of something before the panel, 40 times as far off as the others, which are as stated.
TEST(Verdict, OutliersOfANoiseThatBurstsAreSaid) {
  const auto textWith = [](int outliers) {
    Diagnosis diagnosis = found(0);
    Linearization nominal;
    nominal.rows.resize(200);
    nominal.residual.resize(200);
    for (int i = 0; i < 200; ++i) {
      nominal.rows[static_cast<std::size_t>(i)].channel = kChannel<Pixels>;
      nominal.residual[i] = (i % 2 == 0 ? 1 : -1) * (i < outliers ? 10 : 0.25) * (0.6 + 0.004 * i);
    }
    ChannelNoise& noise = diagnosis.noise.channels[indexOf(kChannel<Pixels>)];
    noise.rows = 200;
    noise.scale = 8;
    judge(diagnosis, nominal);
    EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
    return diagnosis.why;
  };
  EXPECT_NE(textWith(20).find("10 % of its readings are outliers"), std::string::npos) << textWith(20);
  EXPECT_EQ(textWith(1).find("outliers"), std::string::npos) << textWith(1);  // fewer than the budget's
}

TEST(Verdict, TheHypothesesMassIsOne) {
  Diagnosis diagnosis = found(30);
  Candidate other;
  other.effect = kEffectIndex<DvlLatency>;
  diagnosis.alternatives.push_back(
      {{diagnosis.effects[0].candidate, other}, {0, std::log(0.5)}, {1, 0.99}, {}});
  diagnosis = judged(std::move(diagnosis));
  double sum = 0;
  for (const Hypothesis& hypothesis : diagnosis.posterior) sum += hypothesis.mass;
  EXPECT_NEAR(sum, 1, 1e-12);
  // 30 of log likelihood beyond chance, of six parameters, are something else by far.
  EXPECT_TRUE(diagnosis.posterior[0].is_something_else);
  EXPECT_NEAR(diagnosis.posterior[1].mass, 2 * diagnosis.posterior[2].mass, 1e-12);
}

// What came nearest to being named has even odds at most against nothing at all.
TEST(Verdict, WhereNothingIsStatedWhatCameNearestIsAHypothesis) {
  Diagnosis diagnosis = found(0);
  diagnosis.effects.clear();
  for (const double log_evidence : {4.0, std::log(0.5), -20.0}) {
    TestedCandidate tested;
    tested.candidate.effect = kEffectIndex<DvlScale>;
    tested.log_evidence = log_evidence;
    diagnosis.tested.push_back(tested);
  }
  diagnosis = judged(std::move(diagnosis));
  std::vector<double> masses;
  for (const Hypothesis& hypothesis : diagnosis.posterior)
    if (!hypothesis.is_something_else) masses.push_back(hypothesis.mass);
  ASSERT_EQ(masses.size(), 3U) << "nothing, and two that are likelier than one in twenty";
  EXPECT_NEAR(masses[0], 0.4, 1e-12);
  EXPECT_NEAR(masses[1], 0.4, 1e-12);
  EXPECT_NEAR(masses[2], 0.2, 1e-12);
}

// Of what would be named under a tighter budget, parameters are told that the recording knows better than
// was known before.
TEST(Verdict, ARemarkTellsWhatIsKnown) {
  Diagnosis diagnosis = found(0);
  const EffectInfo& lamp = allEffects()[kEffectIndex<Lamp>];
  Allowed allowed;
  allowed.budget = "field";
  allowed.tight_budget = "laboratory";
  allowed.most.candidate.effect = lamp.index;
  const double prior_sigma = parameterOf(lamp.first_scalar).prior_sigma;
  allowed.most.one_step = {{lamp.index, lamp.first_scalar, 0.02, 0.1 * prior_sigma},
                           {lamp.index, lamp.first_scalar + 1, 0.5, 1e3}};
  diagnosis.allowed = allowed;
  diagnosis = judged(std::move(diagnosis));
  ASSERT_FALSE(diagnosis.remarks.empty());
  const std::string& remark = diagnosis.remarks.front();
  EXPECT_NE(remark.find(std::string(parameterOf(lamp.first_scalar).name) + " = 0.02"), std::string::npos)
      << remark;
  EXPECT_EQ(remark.find(parameterOf(lamp.first_scalar + 1).name), std::string::npos) << remark;
}

// The second of two effects is a third as likely not to be there as to be there.
TEST(Verdict, ASetWithoutOneOfItsEffectsIsAHypothesis) {
  Diagnosis diagnosis = found(0);
  diagnosis.log_odds = 50;
  diagnosis.effects[0].log_odds = 40;
  FoundEffect second;
  second.candidate.effect = kEffectIndex<DvlLatency>;
  second.log_odds = std::log(3);
  diagnosis.effects.push_back(second);
  diagnosis = judged(std::move(diagnosis));
  ASSERT_EQ(diagnosis.posterior[0].effects.size(), 2U);
  EXPECT_NEAR(diagnosis.posterior[0].mass, 0.75, 1e-12);
  ASSERT_EQ(diagnosis.posterior[1].effects, std::vector{diagnosis.effects[0].candidate});
  EXPECT_NEAR(diagnosis.posterior[1].mass, 0.25, 1e-12);
}

}  // namespace
}  // namespace fathom
