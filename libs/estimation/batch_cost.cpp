#include "estimation/batch_cost.h"

namespace fathom {

void BatchCost::finishSetup(const std::vector<UnknownBlock>& unknowns, int rows) {
  set_num_residuals(rows);
  for (const std::size_t b : blocks) {
    sizes_.push_back(unknowns[b].size);
    mutable_parameter_block_sizes()->push_back(unknowns[b].size);
  }
}

double huberWeight(double norm, double threshold) {
  return threshold > 0.0 && norm > threshold ? threshold / norm : 1.0;
}

void BatchCost::prepare(const BatchPoint& at, bool with_derivative) {
  compute(at, residual_, with_derivative ? &derivative_ : nullptr);
}

bool BatchCost::Evaluate(double const* const*, double* residuals, double** jacobians) const {
  Eigen::Map<Eigen::VectorXd>(residuals, residual_.size()) = residual_;
  if (jacobians == nullptr) return residual_.allFinite();
  Eigen::Index column = 0;
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    if (jacobians[b] != nullptr)
      for (Eigen::Index i = 0; i < residual_.size(); ++i)
        for (int c = 0; c < sizes_[b]; ++c) jacobians[b][i * sizes_[b] + c] = derivative_(i, column + c);
    column += sizes_[b];
  }
  return residual_.allFinite();
}

}  // namespace fathom
