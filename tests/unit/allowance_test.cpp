#include "diagnosis/allowance.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace fathom {
namespace {

Eigen::SparseMatrix<double> sparse(const Eigen::MatrixXd& dense) { return dense.sparseView(); }

TEST(Allowance, IsWhatTheBudgetLooksLike) {
  // Ten readings that all rise by twice the effect; the budget has an offset of sigma 0.3 that they share.
  const auto columns = sparse(Eigen::MatrixXd::Constant(10, 1, 2)),
             offset = sparse(Eigen::MatrixXd::Ones(10, 1));
  const Eigen::VectorXd scatter = Eigen::VectorXd::Constant(1, 0.3), any = Eigen::VectorXd::Constant(1, 1e6);
  EXPECT_NEAR(allowanceOf(columns, offset, scatter, any)(0, 0), 0.15 * 0.15, 1e-9);
  // As much to either side looks like no effect at all.
  Eigen::MatrixXd either = Eigen::MatrixXd::Ones(10, 1);
  either.topRows(5) *= -1;
  EXPECT_NEAR(allowanceOf(columns, sparse(either), scatter, any)(0, 0), 0, 1e-12);
  // What is held tightly is never large.
  const Eigen::VectorXd tight = Eigen::VectorXd::Constant(1, 1e-3);
  EXPECT_LT(allowanceOf(columns, offset, scatter, tight)(0, 0), 1e-8);
}

TEST(Allowance, LeavesOfInformationWhatIsNews) {
  Eigen::MatrixXd gram(2, 2), allowed(2, 2);
  gram << 400, 30, 30, 100;
  allowed << 0.04, 0.01, 0.01, 0.09;
  // Values known to G^-1 that may be off by A besides are known to their sum.
  const Eigen::MatrixXd news = newsOf(gram, allowed);
  EXPECT_TRUE((news * gram).isApprox((gram.inverse() + allowed).inverse(), 1e-9));
  EXPECT_TRUE(newsOf(gram, Eigen::MatrixXd::Zero(2, 2)).isIdentity(1e-12));
}

TEST(Allowance, IsOfWhatIsOnForAPart) {
  Candidate candidate;
  EXPECT_FALSE(comesAndGoes(candidate));
  candidate.active_s = {3, 9};
  EXPECT_TRUE(comesAndGoes(candidate));
  EXPECT_TRUE(lasting(candidate).isForGood());
  candidate = {};
  candidate.time_s = 4;
  EXPECT_FALSE(comesAndGoes(candidate));
}

}  // namespace
}  // namespace fathom
