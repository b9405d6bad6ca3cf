#pragma once

#include <Eigen/Core>
#include <array>

namespace fathom {

/// A square matrix of N columns, like any of Eigen's, whose columns in memory have one more, hidden row: of
/// 15 or 23 states that makes whole packets of four numbers, aligned ones, which is what processors compute
/// with fastest. The hidden row is zero but inside the kernels (covariance_kernels.h).
template <int N>
class PaddedMatrix
    : public Eigen::Map<Eigen::Matrix<double, N, N>, Eigen::Aligned32, Eigen::OuterStride<N + 1>> {
 public:
  static_assert((N + 1) % 4 == 0);
  using Base = Eigen::Map<Eigen::Matrix<double, N, N>, Eigen::Aligned32, Eigen::OuterStride<N + 1>>;

  PaddedMatrix() : Base(nullptr) { pointAtOwn(); }
  template <class Derived>
  PaddedMatrix(const Eigen::MatrixBase<Derived>& matrix) : PaddedMatrix() {  // NOLINT: as Eigen's convert
    Base::operator=(matrix);
  }
  PaddedMatrix(const PaddedMatrix& other) : Base(nullptr), numbers_(other.numbers_) { pointAtOwn(); }
  PaddedMatrix& operator=(const PaddedMatrix& other) {
    numbers_ = other.numbers_;
    return *this;
  }
  ~PaddedMatrix() = default;
  using Base::operator=;

  /// Column after column, hidden rows included.
  double* padded() { return numbers_.data(); }
  const double* padded() const { return numbers_.data(); }

 private:
  /// As Eigen documents: a map is moved by making it anew in its place.
  void pointAtOwn() { new (static_cast<Base*>(this)) Base(numbers_.data()); }

  alignas(32) std::array<double, static_cast<std::size_t>((N + 1) * N)> numbers_{};
};

}  // namespace fathom
