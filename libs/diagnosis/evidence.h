#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include "core/blocked_matrix.h"

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

/// What the columns of one effect are worth. How large an effect is, is known to orders of magnitude only:
/// its values are N(0, (t sigma)^2), each by itself, t one of a few powers of 4 (Liang et al. 2008: a mixture
/// of g-priors), those above 1 the less likely the larger they are.
class EffectEvidence {
 public:
  static constexpr std::array<double, 6> kSizes{1.0 / 64, 1.0 / 16, 0.25, 1, 4, 16};  ///< t

  EffectEvidence() = default;
  EffectEvidence(const Eigen::MatrixXd& gram, const Eigen::VectorXd& sigma);

  /// ln p(r | effect) - ln p(r | no effect) at the best t, less for having chosen that.
  struct Best {
    double log_bayes_factor = 0;
    double size = 1;  ///< t
  };
  Best best(const Eigen::VectorXd& score) const;
  /// The posterior mean of the values at that.
  Eigen::VectorXd valueAt(const Eigen::VectorXd& score, double size) const;

 private:
  Eigen::MatrixXd scaled_basis_;  // of values in units of sigma, where the gram is diagonal, times sigma
  Eigen::VectorXd values_;        // that diagonal
  std::array<double, kSizes.size()> at_no_score_{};
};

/// Of effects side by side whose sizes are known: `sigma` times those.
double logBayesFactorOf(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                        const Eigen::VectorXd& sigma, const std::vector<double>& sizes);

/// Several effects side by side, each of a size of its own.
struct SizedSet {
  double log_bayes_factor = 0;  ///< each size's own share included
  std::vector<double> size;     ///< t of each
  Evidence evidence;            ///< at these; its Bayes factor without the sizes' shares
};
/// `columns`: so many has each effect, one behind the other. Throws Singular where rounding is all that the
/// readings tell.
SizedSet bestSizes(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score, const Eigen::VectorXd& sigma,
                   const std::vector<Eigen::Index>& columns);

/// Columns whose values scatter by a common sigma, which is itself known to a factor only:
/// ln sigma ~ N(ln scale, log_sd^2).
struct ScaledColumns {
  Eigen::Index first = 0, size = 0;  ///< among all columns; they do not overlap
  double scale = 1, log_sd = 1;
  double start = 0;  ///< where to look for it first; 0: at `scale`
};
struct EstimatedScale {
  double scale = 0;   ///< the likeliest, prior included
  double log_sd = 0;  ///< of its logarithm, by the curvature there
  /// ln of how much likelier the readings are so than at the largest that 99 % of the prior hold; 0 within
  /// it.
  double beyond = 0;
  /// What the values found amount to: root mean square over the readings, of what tells of it. A field that
  /// is rougher than it should be has a large scale, and amounts to little. Infinite where not looked at.
  double amount = std::numeric_limits<double>::infinity();
};

/// The scales under which the readings are likeliest (restricted maximum likelihood, Patterson & Thompson
/// 1971) with their priors, all at once. `sigma`: of the columns in none of the groups;
/// those of the groups are not looked at, and an infinite one holds nothing. The scales of a group whose
/// columns see nothing are its prior's.
std::vector<double> likeliestScales(const BlockedMatrix& gram, const Eigen::VectorXd& score,
                                    const Eigen::VectorXd& sigma, const std::vector<ScaledColumns>& groups);
/// How well they are known, which takes as long as three steps of looking for them.
std::vector<EstimatedScale> estimatedScales(const BlockedMatrix& gram, const Eigen::VectorXd& score,
                                            const Eigen::VectorXd& sigma,
                                            const std::vector<ScaledColumns>& groups,
                                            const std::vector<double>& likeliest);

}  // namespace fathom
