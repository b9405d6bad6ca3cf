#pragma once

#include <Eigen/Core>
#include <vector>

/// The algebra of hypotheses: readings are reduced once to what any column can see of them (Reduced), and
/// what a hypothesis is worth follows from that alone, however many readings there were.
///
/// Readings r = -C c + J x + noise of unit variance, x projected off; of the columns' values c ~ N(0,
/// sigma^2) each by itself. A sigma of 0 leaves a column out.
namespace fathom {

/// Of the columns that a hypothesis has.
struct Evidence {
  /// ln p(r | hypothesis) - ln p(r | no column at all).
  double log_bayes_factor = 0;
  Eigen::VectorXd value;  ///< posterior mean of c; 0 of columns that are left out
  /// Posterior covariance of c; 0 of columns that are left out.
  Eigen::MatrixXd covariance;
};
Evidence evidenceOf(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score, const Eigen::VectorXd& sigma);
/// The first of it alone, which takes a third of the time.
double logBayesFactor(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                      const Eigen::VectorXd& sigma);

/// Columns whose values scatter by a common sigma, which is itself known to a factor only:
/// ln sigma ~ N(ln scale, log_sd^2).
struct ScaledColumns {
  Eigen::Index first = 0, size = 0;  ///< among all columns; they do not overlap
  double scale = 1, log_sd = 1;
};
struct EstimatedScale {
  double scale = 0;   ///< the likeliest, prior included
  double log_sd = 0;  ///< of its logarithm, by the curvature there
};

/// The scales under which the readings are likeliest (restricted maximum likelihood, Patterson & Thompson
/// 1971) with their priors: all at once, by Fisher scoring. `sigma`: of the columns in none of the groups;
/// those of the groups are not looked at. The scales of a group whose columns see nothing are its prior's.
std::vector<EstimatedScale> likeliestScales(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                                            Eigen::VectorXd sigma, const std::vector<ScaledColumns>& groups);

}  // namespace fathom
