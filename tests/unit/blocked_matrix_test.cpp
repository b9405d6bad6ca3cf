#include "core/blocked_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "core/random.h"

namespace fathom {
namespace {

/// Unknowns 1 and 4, 0 and 5 and 2 have readings of their own each, 3 and 6 are in all of them.
struct Example {
  Eigen::MatrixXd whole;
  BlockedMatrix blocked;

  Example() {
    Random random(7);
    const std::vector<std::vector<Eigen::Index>> members{{1, 4}, {0, 5}, {2}};
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(30, 7);
    C.col(3) = random.normals(30, 1);
    C.col(6) = random.normals(30, 1);
    for (std::size_t b = 0; b < members.size(); ++b)
      for (const Eigen::Index k : members[b])
        C.col(k).segment(static_cast<Eigen::Index>(10 * b), 10) = random.normals(10, 1);
    whole = C.transpose() * C;
    blocked.members = members;
    blocked.border = {3, 6};
    blocked.across.resize(5, 2);
    Eigen::Index row = 0;
    for (const auto& own : members) {
      blocked.blocks.push_back(whole(own, own));
      for (const Eigen::Index k : own) blocked.across.row(row++) = whole(k, blocked.border);
    }
    blocked.within = whole(blocked.border, blocked.border);
  }
};

const Eigen::VectorXd kSigma = (Eigen::VectorXd(7) << 0.5, 2, 1, 0.1, 0, 3, 0.7).finished();

// Independent: the whole matrix, inverted without its structure.
TEST(BlockedFactors, AreThoseOfTheWholeMatrix) {
  const Example example;
  const Eigen::MatrixXd M = Eigen::MatrixXd::Identity(7, 7) +
                            Eigen::MatrixXd(kSigma.asDiagonal() * example.whole * kSigma.asDiagonal());
  Random random(8);
  const Eigen::MatrixXd b = random.normals(7, 3);
  for (const BlockedMatrix& A : {example.blocked, BlockedMatrix(example.whole)}) {
    const BlockedFactors factors(A, kSigma);
    ASSERT_TRUE(factors.succeeded());
    EXPECT_NEAR(factors.logDeterminant(), std::log(M.determinant()), 1e-9);
    EXPECT_TRUE(factors.inverse().isApprox(M.inverse(), 1e-9));
    EXPECT_TRUE(factors.inverseDiagonal().isApprox(M.inverse().diagonal(), 1e-9));
    EXPECT_TRUE(factors.solve(b).isApprox(M.inverse() * b, 1e-9));
  }
}

// What nothing holds is what it is where a prior is as wide as can be: off by the prior's weight of 1e-8.
TEST(BlockedFactors, WhatNothingHoldsIsLikeAWidePrior) {
  const Example example;
  Eigen::VectorXd free = kSigma, wide = kSigma;
  free[6] = std::numeric_limits<double>::infinity();
  wide[6] = 1e4;
  const BlockedFactors factors(example.blocked, free), held(example.blocked, wide);
  Random random(9);
  const Eigen::VectorXd b = random.normals(7, 1);
  const Eigen::VectorXd x = factors.units().cwiseProduct(
                            factors.solve(factors.units().cwiseProduct(b)).col(0)),
                        y = held.units().cwiseProduct(held.solve(held.units().cwiseProduct(b)).col(0));
  EXPECT_TRUE(x.isApprox(y, 1e-6));
  EXPECT_NEAR(factors.logDeterminant() - 2 * std::log(factors.units()[6]),
              held.logDeterminant() - 2 * std::log(wide[6]), 1e-6);
}

TEST(BlockedMatrix, LastColumnsAreInTheUnknownsOrder) {
  const Example example;
  EXPECT_TRUE(example.blocked.lastColumns(1).isApprox(example.whole.rightCols(1)));
}

// Less than nothing is told of an unknown: rounding.
TEST(BlockedFactors, SayWhereReadingsWeighMoreThanRounding) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2, 2);
  A(0, 0) = -2;
  EXPECT_FALSE(BlockedFactors(A, Eigen::VectorXd::Ones(2)).succeeded());
}

}  // namespace
}  // namespace fathom
