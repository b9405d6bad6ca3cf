#include "diagnosis/saturated.h"

#include <algorithm>
#include <set>

#include "diagnosis/constants.h"
#include "diagnosis/through_poses.h"
#include "effects/catalogue.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

/// Of an effect that comes and goes, whenever it may be: one peak beside another.
std::vector<Candidate> peaksOf(const Linearization& linear) {
  const Interval span = readingsSpan(linear);
  const double first_s = span.from_s, last_s = span.to_s;
  const double spacing_s = std::max(1e-9, (last_s - first_s) / kPeaks);
  std::vector<Candidate> candidates;
  for (const EffectInfo& effect : allEffects()) {
    if (!hasPeak(effect) || isEstimated(linear, effect.index) || !canShow(linear, effect.index)) continue;
    for (int k = 0; k <= kPeaks; ++k) {
      Candidate candidate;
      candidate.effect = effect.index;
      candidate.peak = {first_s + k * spacing_s, spacing_s};
      candidates.push_back(candidate);
    }
  }
  return candidates;
}

/// Where an effect is estimated of one marker, the same of the others.
std::vector<Candidate> otherMarkers(const Linearization& linear) {
  std::vector<Candidate> candidates;
  for (const UnknownBlock& block : linear.blocks) {
    if (block.kind != UnknownBlock::Kind::effect) continue;
    std::set<int> ids = markersOf(linear, block.index);
    if (ids.empty()) continue;
    for (Eigen::SparseMatrix<double>::InnerIterator entry(linear.J, block.column); entry; ++entry)
      if (entry.value() != 0) ids.erase(linear.rows[static_cast<std::size_t>(entry.row())].markerSeen());
    for (const int id : ids) candidates.push_back({block.index, id, {}, {}, {}});
  }
  return candidates;
}

std::vector<Candidate> allThatMayBe(const Linearization& linear) {
  std::vector<Candidate> candidates = lastingCandidates(linear);
  for (const auto& more : {peaksOf(linear), otherMarkers(linear)})
    candidates.insert(candidates.end(), more.begin(), more.end());
  return candidates;
}

Nuisances unknownsOf(const Linearization& linear, const std::vector<Candidate>& candidates,
                     const NoiseModel& noise) {
  const HeldColumns budget = localFirst(budgetColumns(linear, noise), noise.budget);
  const ThroughPoses through(linear.J, linear.taken, linear.blocks);
  const Eigen::SparseMatrix<double> own = columnsOf(linear, candidates);
  Eigen::VectorXd sigma(budget.sigma.size() + own.cols());
  sigma << budget.sigma, priorSigmas(linear, candidates);
  return {withHeldColumns(linear.J, through.of(sideBySide(budget.columns, own)), sigma),
          {budget.local, sigma.size() - budget.local}};
}

}  // namespace

Saturated::Saturated(const Linearization& linear, const NoiseModel& noise)
    : candidates(allThatMayBe(linear)),
      nuisances(unknownsOf(linear, candidates, noise)),
      residual(Eigen::VectorXd::Zero(nuisances.J().rows())) {
  residual.head(linear.residual.size()) = linear.residual;
  left = nuisances.project(residual);
}

std::unique_ptr<Saturated> saturate(Linearization& linear, const NoiseModel& noise) {
  auto saturated = std::make_unique<Saturated>(linear, noise);
  for (int round = 0; round < kWeightRounds; ++round) {
    if (!applyOtherRobustWeights(linear, {kChannel<Pixels>, kChannel<Markers>}, saturated->left)) break;
    saturated = std::make_unique<Saturated>(linear, noise);
  }
  return saturated;
}

}  // namespace fathom
