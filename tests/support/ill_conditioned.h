#pragma once

#include "core/linear_algebra.h"
#include "localization/measurements.h"
#include "support/random_state.h"

namespace fathom::test {

/// What is hardest on a covariance, for as long as one likes: readings from as good as exact to as good as
/// none, in any order, some with noise that is nearly dependent, and times after which nothing is known.
template <int N>
class IllConditionedRun {
 public:
  ErrorStateFilter<N> filter;

  explicit IllConditionedRun(Instructions instructions) {
    filter.kernels = &covarianceKernels<N>(instructions);
    filter.x = randomState(random_);
    filter.P.diagonal().setConstant(1e4);
    noise_.gyro_bias_sigma_rad_s.setConstant(1e-6);
    noise_.accelerometer_bias_sigma_m_s2.setConstant(1e-6);
  }

  void step() {
    if (++steps_ % 1000 == 0) filter.P.diagonal().template head<9>().array() += 1e4;
    const double variance = std::pow(10.0, random_.uniform(-12.0, 4.0));
    switch (static_cast<int>(random_.uniform(0.0, 6.0))) {
      case 0:
        return filter.predict(random_.uniform(0.0, 0.05), noise_);
      case 1:
        return read<0, 1, 2, 3, 4, 5>(variance);
      case 2:
        return read<6, 7, 8>(variance);
      case 3:
        return read<3, 4, 5, 9, 10, 11, 12, 13, 14>(variance);
      case 4:
        return read<9, 10, 11>(variance);
      default:
        return read<12, 13, 14>(variance);
    }
  }

  bool isSymmetric() const { return filter.P == filter.P.transpose(); }
  /// The least eigenvalue of the correlations: whatever units the coordinates have.
  double leastEigenvalue() const {
    const Eigen::VectorXd scale = filter.P.diagonal().cwiseSqrt().cwiseInverse();
    return eigenOf(scale.asDiagonal() * filter.P * scale.asDiagonal()).values.minCoeff();
  }

 private:
  /// What is expected is read; every other time all components are off by nearly the same.
  template <int... I>
  void read(double variance) {
    constexpr int M = sizeof...(I);
    Eigen::Matrix<double, M, M> R = Eigen::Matrix<double, M, M>::Constant(steps_ % 2 == 0 ? variance : 0.0);
    R.diagonal().setConstant(variance * (1.0 + 1e-3));
    filter.update(directMeasurement<N, I...>(filter.x, filter.x, R));
  }

  Random random_{5};
  ProcessNoise noise_;
  long steps_ = 0;
};

}  // namespace fathom::test
