#pragma once

#include <vector>

#include "diagnosis/whitened_model.h"

namespace fathom {

/// Some of a model's rows by themselves: what is tested on them has the nuisances, as these rows alone
/// determine them, projected off. All that goes in is over the model's rows.
class RowsAlone {
 public:
  RowsAlone(const WhitenedModel& model, std::vector<Eigen::Index> rows);  ///< ascending

  const std::vector<Eigen::Index>& rows() const { return rows_; }
  /// Of columns and the model's residual (see Nuisances::reduce()).
  Reduced reduce(const Eigen::SparseMatrix<double>& columns) const;
  std::vector<Reduced> reduceEach(const Eigen::SparseMatrix<double>& columns,
                                  const std::vector<Eigen::Index>& sizes) const;
  /// C^T P R of columns C and of R.
  Eigen::MatrixXd scores(const Eigen::SparseMatrix<double>& columns, const Eigen::MatrixXd& R) const;
  /// P R, by these rows.
  Eigen::MatrixXd project(const Eigen::MatrixXd& R) const;

 private:
  /// Of the model's rows these, over the nuisances' rows.
  Eigen::SparseMatrix<double> own(const Eigen::SparseMatrix<double>& columns) const;
  Eigen::MatrixXd own(const Eigen::MatrixXd& columns) const;

  std::vector<Eigen::Index> rows_;
  Nuisances nuisances_;
  Eigen::VectorXd residual_;
};

/// What of the columns lowers the residual most, with a normal prior of so much sigma. Those that cannot be
/// less than nothing (none: any can be) and would be are nothing.
Eigen::VectorXd fitted(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                       const Eigen::VectorXd& prior_sigma, const std::vector<bool>& is_positive = {});

}  // namespace fathom
