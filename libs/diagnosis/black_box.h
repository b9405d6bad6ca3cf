#pragma once

#include <Eigen/SparseCore>
#include <cstddef>
#include <string>
#include <vector>

#include "diagnosis/covariate.h"

namespace fathom {

/// The yardstick of physics: a channel's readings corrected by whatever they show, splines over the
/// covariates (of first order: how far they are off in each bin) in every direction, and by what a user does
/// who does not ask why: a camera calibrated anew, sensors mounted anew. Time is no covariate: another
/// stretch, or another recording, is another time.
class BlackBox {
 public:
  /// Bins with equal shares of the readings.
  BlackBox(const Linearization& linear, Channel channel);

  /// d residual / d values over a linearization's rows: of the same recording or another.
  Eigen::SparseMatrix<double> columns(const Linearization& linear) const;
  /// Of the values: splines as large as the noise, the rest as large as it usually is.
  const Eigen::VectorXd& priorSigma() const { return sigma_; }
  /// Whether the effect is itself one of those a user estimates anew.
  static bool isRemedy(std::size_t effect);

 private:
  struct Spline {
    std::string direction, covariate;
    std::vector<double> limits;
  };
  Channel channel_;
  std::vector<Spline> splines_;
  std::vector<std::size_t> remedies_;  // scalars, behind the splines
  Eigen::VectorXd sigma_;
};

}  // namespace fathom
