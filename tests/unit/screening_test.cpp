#include "diagnosis/screening.h"

#include <gtest/gtest.h>

#include "effects/catalogue.h"
#include "support/batch_runs.h"

namespace fathom {
namespace {

constexpr int kSegments = 12;
constexpr double kDuration_s = 12.0, kSegment_s = kDuration_s / kSegments;
constexpr Interval kOdd{4.0, 6.0};

/// A run whose DVL reads a fifth too much for two seconds.
WhitenedModel oddRun() {
  const BatchInput input = test::BatchRun(kDuration_s).input();
  const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  Linearization linear = linearize(input.data, *problemAt(input.data, estimate, {}));
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

}  // namespace
}  // namespace fathom
