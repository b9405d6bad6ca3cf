#pragma once

#include <Eigen/Core>
#include <bitset>
#include <memory>
#include <vector>

#include "estimation/batch_cost.h"
#include "estimation/batch_data.h"
#include "estimation/batch_state.h"
#include "estimation/batch_unknowns.h"
#include "estimation/motion_table.h"
#include "estimation/problem_options.h"
#include "estimation/reading_cost_maker.h"

/// The batch estimate as a least-squares problem: unknowns, and the rows of residuals that they explain.
namespace fathom {

/// The rows of all readings and priors, and the unknowns that explain them.
class BatchProblem {
 public:
  /// Data is referred to and must outlive it.
  BatchProblem(const BatchData& data, const ProblemOptions& options, const BatchState& reference);
  BatchProblem(const BatchProblem&) = delete;
  BatchProblem& operator=(const BatchProblem&) = delete;

  const BatchState& reference() const { return unknowns_.reference(); }
  BatchState at(const Eigen::VectorXd& x) const { return unknowns_.at(x); }
  /// What costs are computed at; the motions' derivatives only where theirs are wanted.
  BatchPoint pointAt(const Eigen::VectorXd& x, bool with_derivatives) const;
  const std::vector<UnknownBlock>& blocks() const { return unknowns_.blocks(); }
  /// Null: not estimated.
  const UnknownBlock* find(UnknownBlock::Kind kind, std::size_t index) const {
    return unknowns_.find(kind, index);
  }
  const UnknownBlock* knotBlock() const { return unknowns_.knotBlock(); }
  int unknowns() const { return unknowns_.size(); }
  const std::vector<std::unique_ptr<BatchCost>>& costs() const { return costs_; }
  /// Those that must be minimized anew where they had been at their minimum before these effects changed:
  /// what shares unknowns with one that depends on them, directly or through others. All of them where poses
  /// are among these unknowns: light is looked at from where they are.
  std::vector<BatchCost*> touchedBy(const std::bitset<kEffectCount>& effects) const;
  /// Of effects that are on, or estimated: by effect, then by image.
  const std::vector<Draw>& draws() const { return unknowns_.draws(); }
  bool estimates(std::size_t effect) const { return options_.estimate[effect]; }
  /// The motion of the reference at a stamp, or on an image.
  Motion motionAt(double t_s, std::size_t image) const { return unknowns_.motionAt(t_s, image); }
  std::size_t behindCamera() const { return behind_camera_; }

 private:
  void addReadings();
  void addMarkers();
  void addTiePoints();
  void addPatches();
  void addBlurs();
  void addSpecks();
  void addTextures();
  void addMotionPriors();
  void addDriftPriors();
  void addPriorsOfConstants();
  void add(std::unique_ptr<ReadingModel> model, const RowSource& source, std::vector<double> node_s,
           Eigen::VectorXd reading, const Eigen::MatrixXd& whitening);

  const BatchData& data_;
  ProblemOptions options_;
  BatchUnknowns unknowns_;
  MotionTable motions_;
  ReadingCostMaker maker_;
  std::size_t behind_camera_ = 0;
  std::vector<std::unique_ptr<BatchCost>> costs_;
};

}  // namespace fathom
