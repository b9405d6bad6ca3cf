#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "estimation/batch_estimate.h"
#include "estimation/linearization.h"

namespace fathom {

/// Of an effect that comes and goes.
struct Peak {
  double time_s = 0, width_s = 0;  ///< the second: a normal curve's standard deviation
  friend bool operator==(const Peak&, const Peak&) = default;
};

/// An effect that may be missing: a registered effect, and what a fit cannot differentiate by.
struct Candidate {
  std::size_t effect = 0;          ///< in the registry
  std::optional<int> marker_id;    ///< where the effect has one
  std::optional<double> time_s;    ///< of a step, where the effect has one
  std::optional<Peak> peak;        ///< where to start from, where the effect has one
  Interval active_s;               ///< the default: for good
  std::optional<Instance> only{};  ///< of several instruments of the kind; nothing: of each
  std::optional<int> sensor{};     ///< place in kSensorKinds, where the effect is of one kind of sensors
  std::optional<int> region{};     ///< place in kImageRegions, where the effect is of one part of the image

  bool isForGood() const { return active_s == Interval{} && !time_s && !peak; }
  friend bool operator==(const Candidate&, const Candidate&) = default;
};

/// The same effect of the same marker, sensor, region or instrument, whenever it is there.
bool isSameButTime(const Candidate& a, const Candidate& b);

/// "marker-moved 14", "panel-moved at 73.2 s", "water-current from 30.0 to 80.0 s".
std::string nameOf(const Candidate& candidate);

/// Switches the effect on; its continuous parameters stay as they are.
void switchOn(EffectParameters<double>& calibration, const Candidate& candidate);

/// Whether the candidate acts on a reading.
bool actsOn(const Candidate& candidate, const RowInfo& row);
/// Whether a fit of it moves the path along with it, see knotEffect().
bool followsKnots(const Candidate& candidate);
/// Whether the effect comes and goes.
bool hasPeak(const EffectInfo& effect);
/// When it does, as a calibration has it.
Peak peakOf(const EffectParameters<double>& calibration, std::size_t effect);

/// One of a candidate's columns: a column of the linearization, of what is drawn for each image the rows of
/// one.
struct CandidateColumn {
  std::size_t column = 0;
  std::ptrdiff_t image = -1;  ///< -1: of all

  bool has(const RowInfo& row) const { return image < 0 || row.image == image; }
};

/// What a fit estimates of the effect: so many columns has the candidate.
std::vector<CandidateColumn> columnsOf(const Linearization& linear, std::size_t effect);

/// Whether any reading depends on the effect.
bool canShow(const Linearization& linear, std::size_t effect);

/// Prior sigmas of all candidates' columns, one behind the other.
Eigen::VectorXd priorSigmas(const Linearization& linear, const std::vector<Candidate>& candidates);

/// Whether a fit can have found this of a scalar: nothing clearly less than nothing. What is drawn of a
/// spread can be either.
bool canBeFound(std::size_t scalar, double value, double sigma);

/// Of a scalar's values that were drawn for the images, with their covariance: how far they spread about
/// their mean, which cannot be told from how bright all is.
EffectEstimate spreadOf(std::size_t scalar, const Eigen::VectorXd& value, const Eigen::MatrixXd& covariance);
/// The same of several scalars' draws, of which each column's is given.
std::vector<EffectEstimate> spreadsOf(const std::vector<std::size_t>& scalars, const Eigen::VectorXd& value,
                                      const Eigen::MatrixXd& covariance);

/// Whether the effect is among what the linearized problem estimates.
bool isEstimated(const Linearization& linear, std::size_t effect);

/// Columns of the candidates, one behind the other, over the linearization's rows: zero where a candidate
/// does not act.
Eigen::SparseMatrix<double> columnsOf(const Linearization& linear, const std::vector<Candidate>& candidates);

/// Ids of all markers seen.
std::set<int> markersOf(const Linearization& linear);

/// The instruments whose readings an effect changes; none where there are not several, or where it is of the
/// world.
std::set<Instance> instancesOf(const Linearization& linear, std::size_t effect);

/// The ids of the markers whose corners or patches an effect changes that is of one marker; none of another.
std::set<int> markersOf(const Linearization& linear, std::size_t effect);

/// The kinds of sensors whose readings an effect changes that is of one kind; none of another.
std::set<int> sensorsOf(const Linearization& linear, std::size_t effect);

/// The parts of the image whose patches an effect changes that is of one part; none of another.
std::set<int> regionsOf(const Linearization& linear, std::size_t effect);

/// Every effect not yet estimated that a fit can differentiate by, for good; those with a marker's id once
/// for each id, those of a kind of sensors or a part of the image once for each; where there are several
/// instruments of the kind, of each too.
std::vector<Candidate> lastingCandidates(const Linearization& linear);

}  // namespace fathom
