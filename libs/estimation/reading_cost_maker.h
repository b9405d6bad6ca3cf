#pragma once

#include <Eigen/Core>
#include <bitset>
#include <map>
#include <memory>
#include <vector>

#include "estimation/batch_unknowns.h"
#include "estimation/motion_table.h"
#include "estimation/problem_options.h"
#include "estimation/readings.h"

namespace fathom {

class ReadingCost;

/// Makes the rows of readings: which effects act on one, which motions it looks at, which unknowns it tells
/// of.
class ReadingCostMaker {
 public:
  /// All are referred to and must outlive it, data, unknowns and motions also the costs. Motions are added
  /// to.
  ReadingCostMaker(const BatchData& data, const ProblemOptions& options, const BatchUnknowns& unknowns,
                   MotionTable& motions)
      : data_(data), options_(options), unknowns_(unknowns), motions_(motions) {}

  /// node_s: stamps whose motions' predictions are averaged (one that is there twice counts once); none of
  /// what the robot's pose does not matter to, or is not to be moved by. whitening: W of the data sheet's
  /// sigmas, see BatchCost.
  std::unique_ptr<BatchCost> make(std::unique_ptr<ReadingModel> model, const RowSource& source,
                                  std::vector<double> node_s, Eigen::VectorXd reading,
                                  const Eigen::MatrixXd& whitening);

 private:
  struct Subject;
  Subject subjectOf(const RowSource& source) const;
  /// `effects`: those of the source's instrument.
  std::bitset<kEffectCount> actingOn(const ReadingModel& model, const RowSource& source,
                                     const EffectParameters<double>& effects) const;
  void setEffects(const Subject& subject, ReadingCost& cost) const;
  void followKnots(ReadingCost& cost) const;
  void setPlaces(const Subject& subject, ForwardPoint& point) const;
  void setMotions(const Subject& subject, std::vector<double> node_s, ReadingCost& cost) const;
  void addOthers(const Subject& subject, ReadingCost& cost) const;
  void linkDrift(ReadingCost& cost) const;
  void linkEffects(ReadingCost& cost) const;
  void linkDraws(const Subject& subject, ReadingCost& cost) const;
  void link(std::size_t block, const std::vector<std::size_t>& scalars, double factor,
            ReadingCost& cost) const;
  double thresholdOf(Channel channel, Eigen::Index rows);

  const BatchData& data_;
  const ProblemOptions& options_;
  const BatchUnknowns& unknowns_;
  MotionTable& motions_;
  std::map<Eigen::Index, double>
      robust_thresholds_;  ///< by rows: a quantile costs more than the rest of a cost
};

}  // namespace fathom
