#pragma once

#include <Eigen/Cholesky>
#include <cmath>

#include "core/geometry.h"

namespace fathom {

/// Differences between what two instruments make of the same, with the constant biases of one that are most
/// likely: they are ordinary, so that only what varies tells, and what is more than instruments have.
template <int Biases>
class BiasFit {
 public:
  using Vector = Eigen::Matrix<double, Biases, 1>;
  struct Fit {
    Vector bias = Vector::Zero();
    double square = 0;       ///< mean of squares, with what so large a bias costs in log likelihood
    double with_biases = 0;  ///< mean of squares as they were added
  };

  /// A difference, and how it falls with the biases.
  void add(const Vector3d& off, const Eigen::Matrix<double, 3, Biases>& by_bias) {
    squares_ += off.squaredNorm(), ++count_;
    product_ += by_bias.transpose() * off;
    normal_ += by_bias.transpose() * by_bias;
  }

  /// Biases are Gaussian with these sigmas, differences with one that is not known, at least `floor`'s root:
  /// log likelihood = -weight ln(square + floor). By minorization and maximization from no bias, so that it
  /// is no worse than without.
  Fit fit(const Vector& sigma, double floor, double weight) const {
    Fit fit;
    if (count_ == 0) return fit;
    const double n = static_cast<double>(count_);
    const Vector prior = sigma.cwiseAbs2().cwiseInverse();
    double square = squares_ / n;
    for (int i = 0; i < kIterations; ++i) {
      const double noise = (square + floor) / (2 * weight);
      const Eigen::Matrix<double, Biases, Biases> sum = normal_ / n;
      fit.bias = (sum + Eigen::Matrix<double, Biases, Biases>((noise * prior).asDiagonal()))
                     .ldlt()
                     .solve(product_ / n);
      square = std::max(0.0, squares_ / n - 2 * fit.bias.dot(product_) / n + fit.bias.dot(sum * fit.bias));
    }
    const double cost = 0.5 * fit.bias.cwiseAbs2().dot(prior);
    fit.with_biases = squares_ / n;
    fit.square = (square + floor) * std::exp(cost / weight) - floor;
    return fit;
  }

 private:
  static constexpr int kIterations = 4;
  double squares_ = 0;
  std::size_t count_ = 0;
  Vector product_ = Vector::Zero();
  Eigen::Matrix<double, Biases, Biases> normal_ = Eigen::Matrix<double, Biases, Biases>::Zero();
};

}  // namespace fathom
