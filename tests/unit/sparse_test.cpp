#include "estimation/sparse.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace fathom {
namespace {

/// One entry in five.
Eigen::SparseMatrix<double> sparse(Eigen::Index rows, Eigen::Index columns, Random& random) {
  Eigen::MatrixXd dense = random.normals(rows, columns);
  const Eigen::MatrixXd chance = random.normals(rows, columns);
  dense = (chance.array() > 0.84).select(dense, 0);
  return dense.sparseView();
}

// More columns than are computed at once; what is added up is the same whoever does it, in the same order but
// for Eigen's dense product.
TEST(Sparse, TransposedTimesIsTheProduct) {
  Random random(1);
  for (const Eigen::Index columns : {1, 64, 65, 200}) {
    const Eigen::SparseMatrix<double> A = sparse(50, 30, random), B = sparse(50, columns, random);
    const Eigen::SparseMatrix<double> product = transposedTimes(A, B);
    EXPECT_TRUE(product.isCompressed());
    const Eigen::MatrixXd expected = Eigen::MatrixXd(A).transpose() * Eigen::MatrixXd(B);
    EXPECT_LT((Eigen::MatrixXd(product) - expected).cwiseAbs().maxCoeff(), 1e-13) << columns;
  }
  EXPECT_EQ(transposedTimes(sparse(5, 3, random), Eigen::SparseMatrix<double>(5, 0)).cols(), 0);
}

// As many columns as are added up at once, one fewer, one more, several times so many.
TEST(Sparse, TheDenseGramIsTheProduct) {
  Random random(2);
  for (const Eigen::Index columns : {0, 1, 63, 64, 65, 200}) {
    const Eigen::SparseMatrix<double> A = sparse(50, columns, random);
    const Eigen::MatrixXd expected = Eigen::MatrixXd(A).transpose() * Eigen::MatrixXd(A);
    const Eigen::MatrixXd gram = denseGramOf(A);
    ASSERT_EQ(gram.cols(), columns);
    EXPECT_LT((gram - expected).norm(), 1e-12) << columns;
  }
}

TEST(Sparse, RowsAndColumnsAreThoseAskedFor) {
  Random random(4);
  const Eigen::SparseMatrix<double> A = sparse(20, 10, random);
  const std::vector<Eigen::Index> rows{2, 3, 19}, columns{7, 0};
  const Eigen::MatrixXd dense = A;
  EXPECT_EQ(Eigen::MatrixXd(rowsOf(A, rows)), dense(rows, Eigen::all));
  EXPECT_EQ(Eigen::MatrixXd(columnsOf(A, columns)), dense(Eigen::all, columns));
}

TEST(Sparse, HeldColumnsAreEstimatedWithTheirPrior) {
  Random random(3);
  const Eigen::SparseMatrix<double> J = sparse(40, 7, random), C = sparse(40, 5, random);
  const Eigen::VectorXd sigma = Eigen::VectorXd::LinSpaced(5, 0.5, 2.0);
  const Eigen::MatrixXd all(withHeldColumns(J, C, sigma));
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(45, 12);
  expected << Eigen::MatrixXd(J), Eigen::MatrixXd(C), Eigen::MatrixXd::Zero(5, 7),
      Eigen::MatrixXd(sigma.cwiseInverse().asDiagonal());
  EXPECT_EQ(all, expected);
}

}  // namespace
}  // namespace fathom
