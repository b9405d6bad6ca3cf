#pragma once

#include <vector>

#include "diagnosis/whitened_model.h"

namespace fathom {

/// Some of a model's rows by themselves, with columns that are tested: all with the nuisances, as these rows
/// alone determine them, projected off.
struct RowsAlone {
  std::vector<Eigen::Index> rows;  ///< of the model
  Eigen::VectorXd residual;
  Eigen::MatrixXd columns;
  Eigen::MatrixXd noise;  ///< simulated, white before the projection
};

/// `columns`, `noise`: over all of the model's rows.
RowsAlone rowsAlone(const WhitenedModel& model, std::vector<Eigen::Index> rows,
                    const Eigen::MatrixXd& columns, const Eigen::MatrixXd& noise);

/// What of the columns lowers the residual most, with a normal prior of so much sigma.
Eigen::VectorXd fitted(const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual,
                       const Eigen::VectorXd& sigma);

}  // namespace fathom
