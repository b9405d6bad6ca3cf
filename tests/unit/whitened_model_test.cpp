#include "diagnosis/whitened_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/linear_run.h"

namespace fathom {
namespace {

constexpr double kCorrelation = 0.6;

/// Of a first-order autoregression over each track of the channel's rows, of unit variance.
Eigen::MatrixXd covarianceOf(const Linearization& linear, Channel channel) {
  const auto rows = std::ssize(linear.rows);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(rows, rows);
  for (const auto& track : linear.tracks) {
    if (linear.rows[track[0]].channel != channel) continue;
    for (std::size_t a = 0; a < track.size(); ++a)
      for (std::size_t b = 0; b < track.size(); ++b)
        covariance(static_cast<Eigen::Index>(track[a]), static_cast<Eigen::Index>(track[b])) =
            std::pow(kCorrelation, std::abs(static_cast<double>(a) - static_cast<double>(b)));
  }
  return covariance;
}

// Independent: the process by its definition, Cov(x_i, x_j) = rho^|i - j|. What is whitened has a variance
// that takes for its rows what was taken off for their neighbours, so equal variances are asked for only.
TEST(Whitener, LeavesAnAutoregressionIndependent) {
  const test::LinearRun run(3.0);
  const Linearization linear = run.linear();
  NoiseModel noise;
  noise.channels[indexOf(kChannel<Dvl>)].correlation = kCorrelation;
  Eigen::SparseMatrix<double> unit(std::ssize(linear.rows), std::ssize(linear.rows));
  unit.setIdentity();
  const Whitener whitener(linear, noise);
  const Eigen::MatrixXd W = whitener * unit;
  const Eigen::MatrixXd whitened = W * covarianceOf(linear, kChannel<Dvl>) * W.transpose();
  std::optional<double> variance;
  for (Eigen::Index i = 0; i < whitened.rows(); ++i) {
    if (linear.rows[static_cast<std::size_t>(i)].channel != kChannel<Dvl>) continue;
    if (!variance) variance = whitened(i, i);
    EXPECT_NEAR(whitened(i, i), *variance, 1e-9 * *variance) << i;
    for (Eigen::Index j = 0; j < i; ++j) EXPECT_NEAR(whitened(i, j), 0, 1e-9 * *variance) << i << " " << j;
  }
  ASSERT_TRUE(variance);
  Random random(3);
  const Eigen::VectorXd v = random.normals(W.rows(), 1);
  EXPECT_TRUE((whitener * v).isApprox(W * v));
  EXPECT_TRUE(whitener.transposed(v).isApprox(W.transpose() * v));
}

}  // namespace
}  // namespace fathom
