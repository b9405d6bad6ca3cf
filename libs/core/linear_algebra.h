#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <stdexcept>

/// Factorizations, compiled once, for matrices of any size: a file that has Eigen make one for a size of its
/// own compiles a second or more longer. Where a small one is in an innermost loop, Eigen's own are faster;
/// for those of hundreds of columns, BLAS, which knows what the processor can.
namespace fathom {

using MatrixView = Eigen::Ref<const Eigen::MatrixXd>;

/// Readings cannot tell unknowns apart, or weigh so much that rounding is all that they tell.
struct Singular : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A symmetric, positive semi-definite A as L D L^T, with pivoting: what A knows nothing of is solved by
/// zero.
class SymmetricFactors {
 public:
  explicit SymmetricFactors(const MatrixView& A);
  ~SymmetricFactors();
  SymmetricFactors(const SymmetricFactors&) = delete;
  SymmetricFactors& operator=(const SymmetricFactors&) = delete;

  bool succeeded() const;
  bool isPositive() const;  ///< or semi-definite
  double logDeterminant() const;
  void solveInPlace(Eigen::Ref<Eigen::MatrixXd> x) const;
  /// A^-1 b.
  template <class B>
  Eigen::Matrix<double, B::RowsAtCompileTime, B::ColsAtCompileTime> solve(
      const Eigen::MatrixBase<B>& b) const {
    Eigen::Matrix<double, B::RowsAtCompileTime, B::ColsAtCompileTime> x = b;
    solveInPlace(x);
    return x;
  }

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

/// A symmetric, positive definite A as L L^T, by BLAS: of large ones much faster than with pivoting.
class PositiveFactors {
 public:
  PositiveFactors() = default;
  explicit PositiveFactors(Eigen::MatrixXd A) { compute(std::move(A)); }

  /// May be called again, of another matrix; its lower half is looked at.
  void compute(Eigen::MatrixXd A);
  bool succeeded() const { return succeeded_; }
  double logDeterminant() const { return 2 * L_.diagonal().array().log().sum(); }
  Eigen::MatrixXd inverse() const;
  /// Its diagonal alone.
  Eigen::VectorXd inverseDiagonal() const;
  void solveInPlace(Eigen::Ref<Eigen::MatrixXd> x) const;
  /// L^-1 x.
  void halfSolveInPlace(Eigen::Ref<Eigen::MatrixXd> x) const;
  template <class B>
  Eigen::Matrix<double, B::RowsAtCompileTime, B::ColsAtCompileTime> solve(
      const Eigen::MatrixBase<B>& b) const {
    Eigen::Matrix<double, B::RowsAtCompileTime, B::ColsAtCompileTime> x = b;
    solveInPlace(x);
    return x;
  }

 private:
  Eigen::MatrixXd inverseOfHalf() const;

  Eigen::MatrixXd L_;  // in the lower half
  bool succeeded_ = false;
};

/// A^T B and A^T A, by BLAS.
Eigen::MatrixXd transposedTimes(const MatrixView& A, const MatrixView& B);
Eigen::MatrixXd transposedTimesItself(const MatrixView& A);

/// A^-1 b, with pivoting.
template <class B>
auto solveSymmetric(const MatrixView& A, const Eigen::MatrixBase<B>& b) {
  return SymmetricFactors(A).solve(b);
}

/// r^T S^-1 r: the square of a residual in units of its covariance (Mahalanobis).
double normalizedSquare(const MatrixView& S, const Eigen::Ref<const Eigen::VectorXd>& r);

bool isPositiveDefinite(const MatrixView& A);

/// W with W A W^T = 1 for a symmetric A: the lower triangular one (nothing where A is not positive definite),
/// and the symmetric one.
std::optional<Eigen::MatrixXd> lowerWhitener(const MatrixView& A);
Eigen::MatrixXd symmetricWhitener(const MatrixView& A);

/// Eigenvalues of a symmetric matrix, the least first, and the vectors as columns.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen eigenOf(const MatrixView& A);

double largestSingularValue(const MatrixView& A);

/// Of a square matrix that has one.
Eigen::MatrixXd inverseOf(const MatrixView& A);

}  // namespace fathom
