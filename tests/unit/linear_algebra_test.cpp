#include "core/linear_algebra.h"

#include <blis.h>
#include <gtest/gtest.h>

namespace fathom {
namespace {

#ifdef __x86_64__
// BLIS's plain C takes four times as long; what has AVX2 has a kernel of its own, however new it is.
TEST(LinearAlgebra, TakesAKernelForThisProcessor) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "an old processor";
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(4, 4);
  EXPECT_EQ(transposedTimes(one, one), one);
  EXPECT_NE(bli_arch_query_id(), BLIS_ARCH_GENERIC);
}
#endif

}  // namespace
}  // namespace fathom
