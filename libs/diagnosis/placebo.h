#pragma once

#include "diagnosis/constants.h"
#include "diagnosis/rows_alone.h"

namespace fathom {

/// The best of all candidates on each draw of noise, and what it gains on stretches it was not trained on.
class Placebo {
 public:
  /// Every lasting candidate at the model's estimate. `noise`: white, kPlacebos draws over the model's rows.
  Placebo(const WhitenedModel& model, const Eigen::MatrixXd& noise, int folds);

  /// One of the folds; several may be taken at once.
  void take(int fold, const RowsAlone& train, const RowsAlone& test);
  /// Gain in likelihood that 95 % of the draws stay below; 0 without folds.
  double percentile95() const;

 private:
  struct Fold {
    std::vector<Reduced> train, test;  // of each candidate
    Eigen::MatrixXd g_train, g_test;   // scores of the draws, of all
  };
  double evidenceOf(std::size_t candidate, Eigen::Index draw) const;
  double gainOf(std::size_t candidate, Eigen::Index draw) const;

  Eigen::SparseMatrix<double> columns_;
  Eigen::MatrixXd noise_;
  std::vector<Eigen::Index> first_, size_;  // of each candidate's columns
  Eigen::VectorXd sigma_;
  std::vector<Fold> folds_;
};

}  // namespace fathom
