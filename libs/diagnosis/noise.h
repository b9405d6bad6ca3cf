#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>

#include "diagnosis/budget_columns.h"
#include "diagnosis/evidence.h"

namespace fathom {

/// The noise that one channel shows.
struct ChannelNoise {
  std::size_t rows = 0;
  double scale = 1;        ///< sigma in units of the one stated (data sheet, or a corner's own covariance)
  double correlation = 0;  ///< of neighbours in a track: a first-order autoregression
  /// Degrees of freedom that the scale was taken from; infinite: as stated.
  double freedom = std::numeric_limits<double>::infinity();

  /// What the sigma is multiplied by where readings are taken as independent: a mean over many then scatters
  /// as it truly does.
  double independentScale() const;
};

/// What readings scatter by for no reason that has a name: each channel's own noise, and the components of
/// the error budget.
struct NoiseModel {
  std::array<ChannelNoise, kChannelCount> channels;  ///< by Channel
  /// What patches of images scatter by besides, share of their light.
  double light_scatter = 0;
  /// What half of a place differs by from all of it; see partVariance().
  double parts = 0;
  ErrorBudget budget;
  /// Of its components, as a recording shows them; none: as declared.
  std::vector<EstimatedScale> scales;
  /// By component (none: of none), owners whose values are not of the others' kind: growth on two markers is
  /// no way in which prints scatter. Each with a sigma of its own.
  std::vector<std::map<Owner, double>> apart;

  const ChannelNoise& of(Channel channel) const { return channels[indexOf(channel)]; }
  /// What a component's values scatter by, in its unit.
  double sigmaOf(std::size_t component) const {
    return scales.empty() ? budget.components[component].sigma : scales[component].scale;
  }
  /// Of an owner that is apart.
  std::optional<double> sigmaApart(std::size_t component, const Owner& owner) const;
  /// With another budget as that declares it: who is apart stays so, where it has the component.
  NoiseModel with(const ErrorBudget& other) const;
  /// With the budget as declared, but for what is apart, and for what nobody states the size of.
  NoiseModel declared() const;
  /// Has a problem take readings for that noisy.
  void applyTo(ProblemOptions& options) const;

 private:
  std::vector<EstimatedScale> declaredScales(const ErrorBudget& other) const;
};

/// The variance, in units of the row's noise, by which a place that is seen in part reads otherwise than all
/// of it would, were NoiseModel::parts 1: of the mean over a part of what varies over short distances, about
/// the mean over all of it. 0: is no patch of a panel.
double partVariance(const RowInfo& row);

/// The budget's columns over a linearization's rows, which is weighted, each with the sigma that holds it.
HeldColumns budgetColumns(const Linearization& linear, const NoiseModel& noise);
/// The same columns held by what a noise says.
HeldColumns heldBy(HeldColumns budget, const NoiseModel& noise);

/// Rows of a track that follow one another without a gap: pairs of neighbours, by row.
std::vector<std::array<std::size_t, 2>> neighbours(const Linearization& linear, Channel channel);

/// To compare what a camera by itself shows: its noise, of all that it sees by.
double cameraNoise(const NoiseModel& noise);
/// Whether a recording shows clearly less noise of any kind than was assumed.
bool isQuieter(const NoiseModel& shown, const NoiseModel& before);

}  // namespace fathom
