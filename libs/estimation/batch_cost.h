#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "estimation/batch_data.h"
#include "estimation/motion_table.h"

/// Rows of a batch problem, and the unknowns that they are of.
namespace fathom {

/// A block of unknowns: coordinates of the error of one part of a reference state.
struct UnknownBlock {
  enum class Kind { pose, drift, sea_floor, panel, right_camera, water, flaws, effect, draw };
  Kind kind = Kind::pose;
  std::size_t index = 0;  ///< in the state's list, of an effect: in the registry, of a draw: in draws()
  int size = 6;
  int column = 0;        ///< of its first coordinate
  std::size_t knot = 0;  ///< of a drift
};

/// What a cost's rows are about.
struct RowSource {
  Channel channel = kChannel<Prior>;
  double t_s = 0.0;
  std::ptrdiff_t marker = -1;     ///< index in BatchData::markers; -1: none
  std::ptrdiff_t tie_point = -1;  ///< likewise
  std::ptrdiff_t patch = -1;
  std::ptrdiff_t blur = -1;
  std::ptrdiff_t specks = -1;
  std::ptrdiff_t texture = -1;
  Instance instance{};  ///< of the instrument
};

/// Coordinates of all unknowns, and the motions that the poses have there.
struct BatchPoint {
  Eigen::VectorXd x;
  Motions motions;
};

/// Huber's weight on the square of a residual of this norm; threshold 0: 1.
double huberWeight(double norm, double threshold);

/// A few rows of residuals, whitened: r = W (reading - prediction).
class BatchCost : public ceres::CostFunction {
 public:
  RowSource source;
  double robust_threshold = 0.0;  ///< on |r|; 0: none
  bool is_wide_prior = false;     ///< see wide_prior.h
  std::vector<std::size_t> blocks;

  /// Derivative: by the coordinates of its blocks, one behind the other; needs the motions' derivatives.
  virtual void compute(const BatchPoint& at, Eigen::VectorXd& residual,
                       Eigen::MatrixXd* derivative) const = 0;
  /// Derivative at the motions of x = 0 by all continuous scalars of all effects, a column each as in
  /// EffectParameters; every one taken as acting here: its marker id is this marker's, its time long past,
  /// its interval open.
  virtual void effectColumns(const Motions&, Eigen::Ref<Eigen::MatrixXd> columns) const { columns.setZero(); }
  /// The same by the effect that knots follow (knotEffect()), the path moving with it.
  virtual Eigen::VectorXd knotColumn(const Motions&) const { return Eigen::VectorXd::Zero(num_residuals()); }

  /// What the rows would change by with poses that they take as they are: by the coordinates of these blocks,
  /// one behind the other, at the motions of x = 0.
  struct ByTaken {
    std::vector<std::size_t> blocks;
    Eigen::MatrixXd derivative;
  };
  virtual ByTaken byTaken(const Motions&) const { return {}; }

  /// Whether an effect, where it is there, could change the rows.
  virtual bool dependsOn(std::size_t) const { return false; }

  /// Residuals, a column each, in the reading's unit: reading - prediction.
  virtual Eigen::MatrixXd raw(const Eigen::MatrixXd& residuals) const { return residuals; }

  /// Computes what Evaluate() then hands out. May run beside others'.
  void prepare(const BatchPoint& at, bool with_derivative);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 protected:
  void finishSetup(const std::vector<UnknownBlock>& unknowns, int rows);

 private:
  std::vector<int> sizes_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd derivative_;
};

}  // namespace fathom
