#include "diagnosis/black_box.h"

#include <gtest/gtest.h>

#include "diagnosis/rows_alone.h"
#include "effects/catalogue.h"
#include "support/batch_runs.h"

namespace fathom {
namespace {

/// What a run's readings contradict the model by, where the lens's first coefficient is wrong by so much; and
/// with the box.
struct Costs {
  double plain = 0, boxed = 0;
};
Costs costsWith(double k1_error) {
  const BatchInput input = test::BatchRun(12.0).input();
  const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  Linearization linear = linearize(input.data, *problemAt(input.data, estimate, {}));
  const Candidate lens{kEffectIndex<LensDistortion>, {}, {}, {}, {}};
  const Eigen::SparseMatrix<double> by_lens = columnsOf(linear, {lens});
  linear.residual -= k1_error * by_lens.col(0);
  const WhitenedModel model(std::move(linear), {});
  const BlackBox box(model.linear(), kChannel<Markers>);
  const Eigen::SparseMatrix<double> columns = box.columns(model.linear());
  const Reduced reduced = model.reduce(columns);
  const Eigen::VectorXd values = fitted(reduced.gram, reduced.score, box.priorSigma());
  return {model.nuisances().project(model.residual()).squaredNorm(),
          model.nuisances().project(model.residual() + model.whitened(columns) * values).squaredNorm()};
}

// What a user does who does not ask why. Held by its prior sigma a few per cent of it stay.
TEST(BlackBox, CalibratesACameraAnew) {
  const Costs right = costsWith(0), wrong = costsWith(0.05);
  ASSERT_GT(wrong.plain, 2 * right.plain);
  EXPECT_NEAR(wrong.boxed, right.boxed, 0.05 * (wrong.plain - right.plain));
}

TEST(BlackBox, KnowsItsRemedies) {
  EXPECT_TRUE(BlackBox::isRemedy(kEffectIndex<FocalScale>));
  EXPECT_FALSE(BlackBox::isRemedy(kEffectIndex<FlatPortRefraction>));
}

}  // namespace
}  // namespace fathom
