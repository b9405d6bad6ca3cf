#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace fathom {

/// Where an affine model of N numbers has this value: what a sensor saw, from what it read. Not finite where
/// the model does not tell.
template <int N, class Model>
Eigen::Matrix<double, N, 1> affineInverse(const Model& model, const Eigen::Matrix<double, N, 1>& value) {
  using Vector = Eigen::Matrix<double, N, 1>;
  const Vector of_nothing = model(Vector::Zero());
  Eigen::Matrix<double, N, N> slope;
  for (int i = 0; i < N; ++i) slope.col(i) = model(Vector::Unit(i)) - of_nothing;
  return slope.inverse() * (value - of_nothing);
}

}  // namespace fathom
