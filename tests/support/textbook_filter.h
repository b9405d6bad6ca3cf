#pragma once

#include <limits>

#include "core/linear_algebra.h"
#include "localization/error_state_filter.h"

namespace fathom::test {

/// The same filter as ErrorStateFilter, written as a textbook writes it: dynamic-size matrices, dense F and
/// H, explicit inverse, Joseph form as printed. Reference for results and for speed.
template <int N>
class TextbookFilter {
 public:
  NavigationState<double> x;
  Eigen::MatrixXd P;

  void predict(double dt, const ProcessNoise& noise) {
    const int steps = std::max(1, static_cast<int>(std::ceil(dt / kMaximumStep_s - 1e-9)));
    const double h = dt / steps;
    for (int k = 0; k < steps; ++k) {
      const Eigen::MatrixXd F = ErrorStateFilter<N>::transition(x, h, noise);
      const Eigen::MatrixXd half_noise = (0.5 * h * ErrorStateFilter<N>::noiseDensity(noise)).asDiagonal();
      P = F * (P + half_noise) * F.transpose() + half_noise;
      ErrorStateFilter<N>::move(x, h, noise);
    }
  }

  template <class Measurement>
  double update(const Measurement& m, const std::vector<int>& columns,
                double gate = std::numeric_limits<double>::infinity()) {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(m.residual.size(), N);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      if constexpr (requires { m.H; })
        H.col(columns[k]) = m.H.col(i);
      else
        H(i, columns[k]) = 1.0;
    }
    const Eigen::MatrixXd R = m.R;
    const Eigen::VectorXd residual = m.residual;
    const Eigen::MatrixXd S = H * P * H.transpose() + R;
    const Eigen::MatrixXd S_inverse = inverseOf(S);
    const double nis = residual.dot(S_inverse * residual);
    if (!(nis <= gate)) return nis;
    const Eigen::MatrixXd K = P * H.transpose() * S_inverse;
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(N, N);
    P = (I - K * H) * P * (I - K * H).transpose() + K * R * K.transpose();
    const Eigen::VectorXd delta = K * residual;
    retract<N>(x, delta);
    Eigen::MatrixXd G = I;
    G.block(kOrientation, kOrientation, 3, 3) = rightJacobianSO3<double>(delta.segment<3>(kOrientation));
    P = G * P * G.transpose();
    return nis;
  }
};

}  // namespace fathom::test
