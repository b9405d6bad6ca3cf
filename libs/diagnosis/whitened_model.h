#pragma once

#include <memory>

#include "diagnosis/candidate.h"
#include "diagnosis/noise.h"
#include "diagnosis/through_poses.h"
#include "estimation/nuisances.h"

namespace fathom {

/// W over a linearization's rows: each by its scale, and without what it has in common with the one before.
class Whitener {
 public:
  Whitener(const Linearization& linear, const NoiseModel& noise);

  Eigen::SparseMatrix<double> operator*(const Eigen::SparseMatrix<double>& columns) const;
  Eigen::VectorXd operator*(const Eigen::VectorXd& column) const;
  /// W^T v.
  Eigen::VectorXd transposed(const Eigen::VectorXd& v) const;

 private:
  Eigen::VectorXd diagonal_;
  Eigen::SparseMatrix<double> below_;
};

/// An estimate's linear model in units of independent noise, as the data shows it: W r, W J, W C. The
/// error budget's components are among the nuisances, held by what they scatter by.
class WhitenedModel {
 public:
  /// `linear` at an estimate with noise.applyTo(), not yet weighted.
  WhitenedModel(Linearization linear, const NoiseModel& noise);
  /// The same of one whose robust weights have been applied.
  struct Weighted {};
  WhitenedModel(Weighted, Linearization linear, const NoiseModel& noise);
  /// And whose budget's columns are at hand.
  WhitenedModel(Weighted, Linearization linear, const NoiseModel& noise, const HeldColumns& budget);
  /// This one under another noise.
  WhitenedModel under(const NoiseModel& noise) const;

  const Linearization& linear() const { return *linear_; }
  const NoiseModel& noise() const { return noise_; }
  /// The budget's columns, like whitened().
  HeldColumns whitenedBudget() const;
  const Nuisances& nuisances() const { return nuisances_; }
  const Eigen::VectorXd& residual() const { return residual_; }
  /// Columns over the linearization's rows, with what they do to light through the poses.
  Eigen::SparseMatrix<double> whitened(const Eigen::SparseMatrix<double>& columns) const;
  /// What each reading's derivative by anything is multiplied by in that one's score.
  Eigen::VectorXd scoreShares() const;
  Reduced reduce(const std::vector<Candidate>& candidates) const;
  /// The same of each by itself, which takes less than all side by side.
  std::vector<Reduced> reduceEach(const std::vector<Candidate>& candidates) const;
  Reduced reduce(const Eigen::SparseMatrix<double>& columns) const {
    return nuisances_.reduce(whitened(columns), residual_);
  }
  /// Half the sum of squares where the unknowns are best, outliers by Huber's loss.
  double cost() const { return costOf(nuisances_.project(residual_)); }
  /// The same of what is left of any residual.
  double costOf(const Eigen::VectorXd& left) const;

 private:
  WhitenedModel(const std::shared_ptr<const Linearization>& linear, const NoiseModel& noise);
  WhitenedModel(const std::shared_ptr<const Linearization>& linear, const NoiseModel& noise,
                const HeldColumns& budget);
  /// A budget's columns with what they do to light.
  struct Followed {
    Followed(const Linearization& linear, HeldColumns all);
    Followed(ThroughPoses poses, HeldColumns of_budget)
        : through(std::move(poses)), budget(std::move(of_budget)) {}
    ThroughPoses through;
    HeldColumns budget;
  };
  WhitenedModel(std::shared_ptr<const Linearization> linear, const NoiseModel& noise, Followed followed);
  Nuisances nuisancesOf() const;
  /// Of columns with what they do to light.
  Eigen::SparseMatrix<double> whitenedOf(const Eigen::SparseMatrix<double>& followed) const;

  std::shared_ptr<const Linearization> linear_;
  NoiseModel noise_;
  Followed followed_;
  Whitener W_;
  Nuisances nuisances_;
  Eigen::VectorXd residual_;
};

}  // namespace fathom
