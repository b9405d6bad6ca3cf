#include "diagnosis/reduced_fit.h"

#include <gtest/gtest.h>

#include "diagnosis/budget_file.h"
#include "support/diagnosis_runs.h"

namespace fathom {
namespace {

Split splitOf(const ReducedFit& fit) {
  Eigen::VectorXd sigma(fit.score().size());
  sigma << fit.budget().sigma, Eigen::VectorXd::Constant(fit.unheld(), ReducedFit::kUnheld);
  return fit.split(sigma, Eigen::VectorXd(0), {});
}

// Where light is compared most of a budget is of one place each. Independent: the same without telling them
// apart, as one dense matrix, the water's unknowns projected off; equal but for rounding.
TEST(ReducedFit, PlacesOneByOneAreWorthTheSame) {
  const BatchInput input = test::plainNull(test::lightDive(), 1).input();
  const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  NoiseModel noise;
  noise.budget = fieldBudget().of(CameraPipeline::linear);
  Linearization linear = linearize(input.data, *problemAt(input.data, estimate, {}));
  applyRobustWeights(linear);
  const HeldColumns budget = budgetColumns(linear, noise);
  HeldColumns whole = budget;
  whole.of_places.clear();
  const ReducedFit by_place(linear, {}, estimate.state, noise, budget),
      at_once(linear, {}, estimate.state, noise, whole);
  EXPECT_GT(by_place.gram().blocks.size(), 10u);
  EXPECT_GT(by_place.unheld(), 0);
  EXPECT_TRUE(at_once.gram().blocks.empty());
  EXPECT_EQ(at_once.unheld(), 0);

  const Split one = splitOf(by_place), other = splitOf(at_once);
  EXPECT_NEAR(by_place.logEvidence(one), at_once.logEvidence(other), 1e-5);
  const Eigen::Index size = budget.sigma.size();
  EXPECT_LT((one.budget.head(size) - other.budget).cwiseQuotient(budget.sigma).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((by_place.leftBy(one) - at_once.leftBy(other)).cwiseAbs().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace fathom
