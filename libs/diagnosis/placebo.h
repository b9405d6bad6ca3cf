#pragma once

#include "diagnosis/constants.h"
#include "diagnosis/rows_alone.h"

namespace fathom {

/// The best of all candidates on each draw of noise, and what it gains on stretches it was not trained on.
class Placebo {
 public:
  /// Every lasting candidate at the model's estimate. `noise`: white, kPlacebos draws over the model's rows.
  Placebo(const WhitenedModel& model, const Eigen::MatrixXd& noise, int folds);

  /// One of the folds, all rows but those that are held out; several may be taken at once.
  void take(int fold, const RowsAlone& train);
  /// Gain in likelihood that 95 % of the draws stay below; 0 without folds.
  double percentile95() const;

 private:
  /// Of some rows.
  struct Seen {
    std::vector<Reduced> each;  // of each candidate
    Eigen::MatrixXd scores;     // of the draws, of all candidates
  };
  double evidenceOf(std::size_t candidate, Eigen::Index draw) const;
  double gainOf(std::size_t candidate, Eigen::Index draw) const;

  Eigen::SparseMatrix<double> columns_;
  Eigen::MatrixXd noise_;
  std::vector<Eigen::Index> first_, size_;  // of each candidate's columns
  Eigen::VectorXd sigma_;
  Seen all_;
  std::vector<Seen> trained_;  // by fold
};

}  // namespace fathom
