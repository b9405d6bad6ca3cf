#include "core/linear_algebra.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fathom {

struct SymmetricFactors::Factors {
  Eigen::LDLT<Eigen::MatrixXd> ldlt;
};

SymmetricFactors::SymmetricFactors(const MatrixView& A) : factors_(std::make_unique<Factors>()) {
  factors_->ldlt.compute(A);
}

SymmetricFactors::~SymmetricFactors() = default;

bool SymmetricFactors::succeeded() const { return factors_->ldlt.info() == Eigen::Success; }

bool SymmetricFactors::isPositive() const { return factors_->ldlt.isPositive(); }

double SymmetricFactors::logDeterminant() const {
  const Eigen::VectorXd D = factors_->ldlt.vectorD();
  return D.array().log().sum();
}

void SymmetricFactors::solveInPlace(Eigen::Ref<Eigen::MatrixXd> x) const {
  const Eigen::MatrixXd b = x;
  x = factors_->ldlt.solve(b);
}

struct PositiveFactors::Factors {
  Eigen::LLT<Eigen::MatrixXd> llt;
};

PositiveFactors::PositiveFactors() : factors_(std::make_unique<Factors>()) {}
PositiveFactors::PositiveFactors(const MatrixView& A) : PositiveFactors() { compute(A); }
PositiveFactors::~PositiveFactors() = default;

void PositiveFactors::compute(const MatrixView& A) { factors_->llt.compute(A); }

bool PositiveFactors::succeeded() const { return factors_->llt.info() == Eigen::Success; }

double PositiveFactors::logDeterminant() const {
  return 2 * factors_->llt.matrixLLT().diagonal().array().log().sum();
}

void PositiveFactors::solveInPlace(Eigen::Ref<Eigen::MatrixXd> x) const { factors_->llt.solveInPlace(x); }

void PositiveFactors::halfSolveInPlace(Eigen::Ref<Eigen::MatrixXd> x) const {
  factors_->llt.matrixL().solveInPlace(x);
}

double normalizedSquare(const MatrixView& S, const Eigen::Ref<const Eigen::VectorXd>& r) {
  return r.dot(solveSymmetric(S, r));
}

bool isPositiveDefinite(const MatrixView& A) {
  return Eigen::LLT<Eigen::MatrixXd>(A).info() == Eigen::Success;
}

std::optional<Eigen::MatrixXd> lowerWhitener(const MatrixView& A) {
  const Eigen::LLT<Eigen::MatrixXd> llt(A);
  if (llt.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(A.rows(), A.cols());
  llt.matrixL().solveInPlace(inverse);
  return inverse;
}

Eigen::MatrixXd symmetricWhitener(const MatrixView& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).operatorInverseSqrt();
}

SymmetricEigen eigenOf(const MatrixView& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

double largestSingularValue(const MatrixView& A) {
  return std::sqrt(std::max(0.0, eigenOf(A.transpose() * A).values.maxCoeff()));
}

Eigen::MatrixXd inverseOf(const MatrixView& A) { return A.inverse(); }

}  // namespace fathom
