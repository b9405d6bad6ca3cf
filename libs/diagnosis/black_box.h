#pragma once

#include <vector>

#include "diagnosis/covariate.h"

namespace fathom {

/// The yardstick of physics: a channel's readings corrected by whatever they show, splines over the
/// covariates (of first order: how far they are off in each bin) in every direction. Time is none of them:
/// another stretch, or another recording, is another time.
class BlackBox {
 public:
  /// Bins with equal shares of the readings.
  BlackBox(const Linearization& linear, Channel channel);

  /// d residual / d values over a linearization's rows: of the same recording or another.
  Eigen::SparseMatrix<double> columns(const Linearization& linear) const;
  /// Of the values: as large as the noise.
  Eigen::VectorXd priorSigma() const { return Eigen::VectorXd::Constant(count_, sigma_); }

 private:
  struct Spline {
    std::string direction, covariate;
    std::vector<double> limits;
  };
  Channel channel_;
  std::vector<Spline> splines_;
  Eigen::Index count_ = 0;
  double sigma_ = 0;
};

}  // namespace fathom
