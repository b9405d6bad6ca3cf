#pragma once

#include <Eigen/Core>
#include <bitset>
#include <cstddef>
#include <optional>

#include "estimation/batch_unknowns.h"

/// What is known of a batch problem's unknowns before any reading.
namespace fathom {

/// Rows value + slope x, whitened: x are the coordinates of one block, or of two, one behind the other.
struct PriorRows {
  Eigen::VectorXd value;
  Eigen::MatrixXd slope;
  bool is_wide = false;  ///< not normal, but as in wide_prior.h
};

/// Of what is constant; nothing of poses and drifts. estimate: effects whose continuous parameters are
/// unknown.
std::optional<PriorRows> priorOf(const UnknownBlock& block, const BatchData& data,
                                 const BatchUnknowns& unknowns, const std::bitset<kEffectCount>& estimate);

/// A drift's k-th knot: stationary at first, then b' = phi b + noise. x: of the k-th, then of the one before
/// it, of which the first has none.
PriorRows driftPrior(const Drift& drift, const DriftTrack& track, double interval_s, std::size_t k);

}  // namespace fathom
