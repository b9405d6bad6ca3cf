#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "estimation/linearization.h"

/// What a mismatch may depend on, and how a reading may be off: the physics-free language in which a mismatch
/// is located, whatever its cause.
namespace fathom {

/// A number that each reading has.
struct Covariate {
  std::string name, unit;
  std::function<double(const RowInfo&)> of;
  double scale = 1;  ///< of the unit: what is printed is of(row) * scale
  int bins = 6;
  /// By how much it varies within a reading that is a mean: a standard deviation.
  std::function<double(const RowInfo&)> spread = [](const RowInfo&) { return 0.0; };
};

/// Those that a channel's readings have, where they vary at all.
std::vector<Covariate> covariatesOf(const Linearization& linear, Channel channel);
/// Whether readings of any channel have one of that name.
bool isCovariate(const std::string& name);

/// A way in which a channel's readings may be off, one unit's worth: an axis's own unit; of markers' corners
/// a shift of the image by a pixel, to the right or down.
struct Direction {
  std::string name;            ///< "x", "right", …
  std::vector<double> values;  ///< by row of the linearization: d residual
  int component = 0;           ///< of the reading: axis, or 0: image x, 1: image y
};

/// Which of its reading's components a row is: axis, or 0: image x, 1: image y.
int componentOf(const RowInfo& row);

std::vector<Direction> directionsOf(const Linearization& linear, Channel channel);
/// What one unit of noise is in the reading's own unit: of readings that count by what they tell.
double noiseUnit(const Linearization& linear, Channel channel);

/// Readings by equal shares of a covariate, those that have it: each bin's limits, from the first's lower
/// one.
std::vector<double> binLimits(const Linearization& linear, Channel channel, const Covariate& covariate);
/// The number of a value's bin; none of what is not finite.
std::optional<std::size_t> binOf(const std::vector<double>& limits, double value);

}  // namespace fathom
