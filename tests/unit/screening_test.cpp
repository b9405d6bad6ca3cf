#include "diagnosis/screening.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "diagnosis/onset.h"
#include "effects/catalogue.h"
#include "support/linear_run.h"
#include "support/sanitized.h"

namespace fathom {
namespace {

constexpr int kSegments = 12;
constexpr double kDuration_s = 12.0, kSegment_s = kDuration_s / kSegments;
constexpr Interval kOdd{4.0, 6.0};

/// A run whose DVL reads a fifth too much for two seconds.
WhitenedModel oddRun() {
  Linearization linear = test::LinearRun(kDuration_s).linear();
  const Candidate scale{kEffectIndex<DvlScale>, {}, {}, {}, {}};
  const Eigen::VectorXd column = columnsOf(linear, {scale}) * Eigen::VectorXd::Ones(1);
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (kOdd.contains(linear.rows[i].t_s))
      linear.residual[static_cast<Eigen::Index>(i)] -= 0.2 * column[static_cast<Eigen::Index>(i)];
  return {std::move(linear), {}};
}

/// The best part of the effect, where one was tried.
std::optional<Interval> bestPartOf(const Screening& screening, std::size_t effect) {
  for (const TestedCandidate& tested : screening.candidates())
    if (tested.candidate.effect == effect && !tested.candidate.isForGood()) return tested.candidate.active_s;
  return {};
}

TEST(Screening, FindsTheTimeAtWhichAnEffectIsThere) {
  const auto part = bestPartOf(Screening(oddRun(), kSegments), kEffectIndex<DvlScale>);
  ASSERT_TRUE(part);
  EXPECT_NEAR(part->from_s, kOdd.from_s, 0.5 * kSegment_s);
  EXPECT_NEAR(part->to_s, kOdd.to_s, 0.5 * kSegment_s);
}

// The first of two parts says nothing: it gets shorter, but does not end before the recording begins.
TEST(Onset, KeepsNoPartWithoutReadings) {
  const WhitenedModel model = oddRun();
  Candidate parts{kEffectIndex<DvlScale>, {}, {}, {}, {}};
  parts.active_s.to_s = 5.5;
  parts.active_s.pauses[0] = {0.6, 4.5};
  const Interval found = refinedInterval(model, parts, 1.0).active_s, span = readingsSpan(model.linear());
  ASSERT_EQ(found.parts().size(), 2U);
  EXPECT_GT(found.parts()[0][1], span.from_s);
  EXPECT_LT(found.parts()[0][1], 0.6);
  EXPECT_NEAR(found.parts()[1][0], kOdd.from_s, 0.2);  // between two readings of the DVL
  EXPECT_NEAR(found.parts()[1][1], kOdd.to_s, 0.2);
}

TEST(Screening, TriesNoPartThatNoStretchIsLeftToFit) {
  const double least_s = 4 * kSegment_s;
  LeftOut left_out;
  left_out.shorter_s = least_s;
  const auto part = bestPartOf(Screening(oddRun(), kSegments, left_out), kEffectIndex<DvlScale>);
  ASSERT_TRUE(part);
  // Finer edges are tried within half a segment of either end.
  EXPECT_GE(std::min(part->to_s, kDuration_s) - std::max(part->from_s, 0.0), least_s - kSegment_s);
}

TEST(Screening, TriesNoPartWhoseBestExplanationDidNotHold) {
  LeftOut left_out;
  left_out.during.push_back(kOdd);
  const Screening screening(oddRun(), kSegments, left_out);
  for (const TestedCandidate& tested : screening.candidates()) {
    const Interval& part = tested.candidate.active_s;
    if (tested.candidate.isForGood() || tested.candidate.time_s || tested.candidate.peak) continue;
    EXPECT_TRUE(part.from_s < kOdd.from_s - 0.5 * kSegment_s || part.to_s > kOdd.to_s + 0.5 * kSegment_s)
        << nameOf(tested.candidate);
  }
}

// Of an effect that lasts or is on from one edge to another: all that may be are together as likely as it is,
// one of so many.
TEST(PriorOdds, OfAnEffectsTimesMakeOneEffect) {
  const Linearization linear = test::LinearRun(6.0).linear();
  const PriorOdds prior(linear, kSegments);
  Candidate candidate{kEffectIndex<DvlScale>, {}, {}, {}, {}};
  double sum = std::exp(prior.logOf(candidate));
  for (int from = 0; from < kSegments; ++from)
    for (int to = from + 1; to <= kSegments; ++to) {
      candidate.active_s = {static_cast<double>(from), static_cast<double>(to)};
      sum += std::exp(prior.logOf(candidate));
    }
  double effects = 0;
  for (const EffectInfo& effect : allEffects()) effects += canShow(linear, effect.index);
  EXPECT_NEAR(sum, 1 / effects, 1e-12);
}

// Readings that differ from the model by noise alone reach what one in ten is said to reach about so often:
// of 40 draws 4, ten or more with a probability of 5e-3.
TEST(Screening, SaysHowOftenChanceIsSoLikely) {
  if (test::kSanitized) GTEST_SKIP() << "a minute under sanitizers: the tests above take the same way there";
  constexpr int kDraws = 40, kCoarse = 4;
  const test::LinearRun run(6.0);
  const WhitenedModel model = run.model();
  const double usual_best = Screening(model, kCoarse).chance(1).evidenceOf(0.1);
  Random random(5);
  int reached = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Linearization linear = model.linear();
    linear.residual = random.normals(linear.residual.size(), 1);
    double best = -1e300;
    const Screening screening(WhitenedModel(WhitenedModel::Weighted{}, std::move(linear), {}), kCoarse);
    for (const TestedCandidate& tested : screening.candidates()) best = std::max(best, tested.log_evidence);
    reached += best >= usual_best;
  }
  EXPECT_LE(reached, 9);
  EXPECT_GE(reached, 1);
}

}  // namespace
}  // namespace fathom
