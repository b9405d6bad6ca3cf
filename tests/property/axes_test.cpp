#include "recording/axes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/random.h"

namespace fathom {
namespace {

/// Expected and measured differ by these axes and a little noise.
AxesEvidence evidence(const SignedAxes& axes, double noise, std::uint64_t seed) {
  Random random(seed);
  AxesEvidence e;
  for (int k = 0; k < 100; ++k) {
    const Vector3d measured = random.normal3();
    e.add(axes.matrix() * measured + noise * random.normal3(), measured);
  }
  return e;
}

TEST(Axes, AreFortyEightHalfOfThemRotations) {
  const auto ranked = AxesEvidence{}.ranking();
  ASSERT_EQ(ranked.size(), 48U);
  EXPECT_EQ(std::count_if(ranked.begin(), ranked.end(), [](const auto& s) { return s.axes.proper(); }), 24);
  for (const AxesScore& s : ranked)
    EXPECT_TRUE((s.axes.matrix() * s.axes.matrix().transpose()).isIdentity()) << s.axes.text();
}

TEST(Axes, WithoutEvidenceNothingIsChanged) {
  EXPECT_EQ(AxesEvidence{}.ranking()[0].axes, SignedAxes{});
  AxesEvidence standing_still;
  for (int k = 0; k < 10; ++k) standing_still.add(Vector3d::Zero(), Vector3d::Zero());
  EXPECT_EQ(standing_still.ranking()[0].axes, SignedAxes{});
}

TEST(Axes, TextNamesSourceAndSign) { EXPECT_EQ((SignedAxes{{1, 0, 2}, {1, -1, 1}}.text()), "(y, -x, z)"); }

RC_GTEST_PROP(Axes, AreRecoveredFromData, (std::uint64_t seed)) {
  const auto all = AxesEvidence{}.ranking();
  const SignedAxes axes = all[*rc::gen::inRange<std::size_t>(0, 48)].axes;
  const auto ranked = evidence(axes, 0.1, seed).ranking();
  RC_ASSERT(ranked[0].axes == axes);
  for (int i = 0; i < 3; ++i)  // a sample of 100 scatters by 7 %
    RC_ASSERT(std::abs(ranked[0].residual_rms[i] - 0.1) < 0.04);
}

TEST(Axes, ExactDataNeitherDividesByZeroNorLosesItsWay) {
  const SignedAxes axes{{2, 0, 1}, {-1, 1, -1}};
  const auto ranked = evidence(axes, 0.0, 1).ranking();
  EXPECT_EQ(ranked[0].axes, axes);
  EXPECT_TRUE(std::isfinite(ranked[0].log_likelihood));
}

}  // namespace
}  // namespace fathom
