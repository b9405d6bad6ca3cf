#include <gtest/gtest.h>

#include "proof/plan.h"

namespace fathom::proof {
namespace {

// What hides nothing needs no size, so that no program runs: these are none.
TEST(ProofPlan, OfWhatHidesNothingTakesNoTime) {
  Extent extent = wholeProof();
  extent.nulls = 7;
  extent.kinds = {ProofCase::Kind::null};
  const std::vector<ProofCase> cases = planProof(extent, {"none", "none"}, "none");
  ASSERT_EQ(cases.size(), 7u);
  for (const ProofCase& c : cases) EXPECT_EQ(c.kind, ProofCase::Kind::null);
  EXPECT_NE(cases[0].generator["seed"], cases[1].generator["seed"]);
}

}  // namespace
}  // namespace fathom::proof
