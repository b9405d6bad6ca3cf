#include "core/linear_algebra.h"

#include <blis.h>
#include <cblas.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

namespace fathom {
namespace {

/// BLIS 0.9 knows AMD's processors by their family, and for a newer one, as are all with AVX-512, takes plain
/// C, which is four times as slow (BLIS_ARCH_DEBUG=1 tells what it takes).
[[maybe_unused]] const bool kKernelsChosen = [] {
#ifdef __x86_64__
  __builtin_cpu_init();
  if (__builtin_cpu_is("amd") && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
    ::setenv("BLIS_ARCH_TYPE", std::to_string(BLIS_ARCH_SKX).c_str(), /*overwrite=*/0);
#endif
  return true;
}();

}  // namespace

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

namespace {

int sizeOf(Eigen::Index size) { return static_cast<int>(size); }

constexpr Eigen::Index kPanel = 64;

/// x = L^-1 x, or L^-T x.
void solveTriangular(const MatrixView& L, CBLAS_TRANSPOSE transposed, Eigen::Ref<Eigen::MatrixXd> x) {
  if (x.size() > 0)
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, transposed, CblasNonUnit, sizeOf(x.rows()),
                sizeOf(x.cols()), 1, L.data(), sizeOf(L.outerStride()), x.data(), sizeOf(x.outerStride()));
}

}  // namespace

/// Panel by panel: its own square, what is below it, and what that takes from the rest (right-looking, Golub
/// & Van Loan, section 4.2.9).
void PositiveFactors::compute(Eigen::MatrixXd A) {
  L_ = std::move(A);
  succeeded_ = true;
  for (Eigen::Index first = 0; first < L_.rows() && succeeded_; first += kPanel) {
    const Eigen::Index size = std::min(kPanel, L_.rows() - first), below = L_.rows() - first - size;
    auto own = L_.block(first, first, size, size);
    const Eigen::LLT<Eigen::MatrixXd> llt(own);
    own = llt.matrixLLT();
    succeeded_ = llt.info() == Eigen::Success && own.diagonal().allFinite();  // Eigen lets NaN pass
    if (below == 0 || !succeeded_) continue;
    const int stride = sizeOf(L_.rows());
    double* panel = &L_(first + size, first);
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, sizeOf(below), sizeOf(size),
                1, own.data(), stride, panel, stride);
    cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, sizeOf(below), sizeOf(size), -1, panel, stride, 1,
                &L_(first + size, first + size), stride);
  }
}

/// L^-1, panel by panel: a column has nothing above its own row, a third of the work.
Eigen::MatrixXd PositiveFactors::inverseOfHalf() const {
  Eigen::MatrixXd half = Eigen::MatrixXd::Identity(L_.rows(), L_.cols());
  for (Eigen::Index first = 0; first < L_.rows(); first += kPanel) {
    const Eigen::Index size = std::min(kPanel, L_.rows() - first), below = L_.rows() - first;
    solveTriangular(L_.bottomRightCorner(below, below), CblasNoTrans, half.block(first, first, below, size));
  }
  return half;
}

/// L^-T L^-1.
Eigen::MatrixXd PositiveFactors::inverse() const { return transposedTimesItself(inverseOfHalf()); }

Eigen::VectorXd PositiveFactors::inverseDiagonal() const { return inverseOfHalf().colwise().squaredNorm(); }

void PositiveFactors::solveInPlace(Eigen::Ref<Eigen::MatrixXd> x) const {
  halfSolveInPlace(x);
  solveTriangular(L_, CblasTrans, x);
}

void PositiveFactors::halfSolveInPlace(Eigen::Ref<Eigen::MatrixXd> x) const {
  solveTriangular(L_, CblasNoTrans, x);
}

Eigen::MatrixXd transposedTimes(const MatrixView& A, const MatrixView& B) {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(A.cols(), B.cols());
  if (product.size() > 0 && A.rows() > 0)
    cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, sizeOf(A.cols()), sizeOf(B.cols()), sizeOf(A.rows()),
                1, A.data(), sizeOf(A.outerStride()), B.data(), sizeOf(B.outerStride()), 0, product.data(),
                sizeOf(product.rows()));
  return product;
}

Eigen::MatrixXd transposedTimesItself(const MatrixView& A) {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(A.cols(), A.cols());
  if (product.size() > 0 && A.rows() > 0)
    cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, sizeOf(A.cols()), sizeOf(A.rows()), 1, A.data(),
                sizeOf(A.outerStride()), 0, product.data(), sizeOf(product.rows()));
  return product.selfadjointView<Eigen::Lower>();
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
