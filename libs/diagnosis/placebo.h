#pragma once

#include "diagnosis/rows_alone.h"

namespace fathom {

inline constexpr int kPlacebos = 20;  ///< draws of noise

/// The best of all candidates on each draw of noise, and what it gains on stretches it was not trained on.
class Placebo {
 public:
  /// Every lasting candidate at an estimate.
  explicit Placebo(const Linearization& linear);

  /// Of a linearization's rows: what add() wants among the columns of its rows.
  Eigen::SparseMatrix<double> columns() const { return columns_; }
  /// A fold; `first`: where the candidates' are among the columns of its rows. Of the noise the first
  /// kPlacebos draws are taken.
  void add(const RowsAlone& train, const RowsAlone& test, Eigen::Index first);
  /// Gain in likelihood that 95 % of the draws stay below; 0 without folds.
  double percentile95() const;

 private:
  struct Fold {
    Eigen::MatrixXd A_train, A_test, g_train, g_test;
  };
  double supportOf(std::size_t candidate, Eigen::Index draw) const;
  double gainOf(std::size_t candidate, Eigen::Index draw) const;

  Eigen::SparseMatrix<double> columns_;
  std::vector<Eigen::Index> first_, size_;  // of each candidate's columns
  Eigen::VectorXd sigma_;
  std::vector<Fold> folds_;
};

}  // namespace fathom
