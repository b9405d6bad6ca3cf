#include "diagnosis/held_out.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "diagnosis/placebo.h"
#include "effects/catalogue.h"
#include "support/linear_run.h"

namespace fathom {
namespace {

Candidate lasting(std::size_t effect) { return {effect, {}, {}, {}, {}}; }

HeldOutGain gainOf(const test::LinearRun& run, const std::vector<Candidate>& effects) {
  HeldOutOptions options;
  options.yardsticks = false;
  return holdOut(run.linear(), effects, run.estimate.state, {}, run.input.data, options).gain;
}

// What was fitted to readings gains on them half of each parameter, and as much less on others. Effects that
// each image shows by itself, since where poses follow them held-out stretches tell little: here it is -12,
// and +14 where held-out stretches are trained on too.
TEST(HeldOut, WhatIsNotThereGainsNothing) {
  const std::vector<Candidate> effects{lasting(kEffectIndex<LensDistortion>),
                                       lasting(kEffectIndex<PanelShape>)};
  double gain = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    for (const double own : gainOf(test::LinearRun(12.0, seed), effects).by_effect) gain += own;
  }
  EXPECT_LT(gain, 0);
}

// A stretch tells less of an effect, given all others, than all stretches together; those of all folds in sum
// may tell more, since what all share, as where markers are, each has from the others.
TEST(HeldOut, WhatIsThereGainsMuchOfWhatItExplains) {
  const test::LinearRun run(12.0);
  Linearization linear = run.linear();
  const Candidate lens = lasting(kEffectIndex<LensDistortion>);
  const Eigen::SparseMatrix<double> columns = columnsOf(linear, {lens});
  constexpr double kK1 = 0.1;
  linear.residual -= kK1 * columns.col(0);
  HeldOutOptions options;
  options.yardsticks = false;
  const HeldOutGain gain = holdOut(linear, {lens}, run.estimate.state, {}, run.input.data, options).gain;
  const Reduced reduced = WhitenedModel(linear, {}).reduce({lens});
  const double all = 0.5 * kK1 * kK1 * reduced.gram(0, 0);
  ASSERT_GT(all, 50);
  EXPECT_GT(gain.by_effect[0], 0.5 * all);
  EXPECT_LT(gain.by_effect[0], options.folds * all);
}

// What a stretch by itself knows little of, as where the robot is, costs it nothing, be it ten metres away: a
// current that lasts for a part of a dive moves the path so far, and is no loss of the path's.
TEST(RowsAlone, APathThatIsElsewhereCostsNothing) {
  const test::LinearRun run(12.0);
  const WhitenedModel model = run.model();
  const Eigen::SparseMatrix<double>& J = model.nuisances().J();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(J.cols());
  for (const UnknownBlock& block : model.linear().blocks)
    if (block.kind == UnknownBlock::Kind::pose) x.segment<3>(block.column).setConstant(10);
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < model.linear().rows.size(); ++i)
    if (model.linear().rows[i].t_s < 6) rows.push_back(static_cast<Eigen::Index>(i));
  EXPECT_LT(RowsAlone(model, rows).project(J * x).squaredNorm(), 0.01);
}

/// What each of the draws gains, by itself.
double gainOfDraw(const WhitenedModel& model, const Eigen::VectorXd& draw, const RowsAlone& train) {
  Placebo alone(model, draw.replicate(1, kPlacebos), 1);
  alone.take(0, train);
  return alone.percentile95();
}

TEST(Placebo, IsBeatenByOneInTwentyAtMost) {
  const test::LinearRun run(6.0);
  const WhitenedModel model = run.model();
  std::vector<Eigen::Index> even;
  for (Eigen::Index i = 0; i < model.residual().size(); ++i)
    if (i / 40 % 2 == 0) even.push_back(i);
  const RowsAlone train(model, even);
  Random random(3);
  const Eigen::MatrixXd noise = random.normals(model.residual().size(), kPlacebos);
  Placebo placebo(model, noise, 1);
  placebo.take(0, train);
  const double limit = placebo.percentile95();
  std::vector<double> gains;
  for (Eigen::Index draw = 0; draw < kPlacebos; ++draw)
    gains.push_back(gainOfDraw(model, noise.col(draw), train));
  EXPECT_LE(std::count_if(gains.begin(), gains.end(), [&](double gain) { return gain > limit; }),
            kPlacebos / 20 - 1);
  EXPECT_NE(std::find(gains.begin(), gains.end(), limit), gains.end()) << "what one of them gains";
}

}  // namespace
}  // namespace fathom
