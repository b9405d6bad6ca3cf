#include "diagnosis/candidate.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/text.h"
#include "diagnosis/constants.h"
#include "effects/drawn.h"
#include "effects/image_regions.h"
#include "effects/peak.h"
#include "effects/sensor_kinds.h"

namespace fathom {

std::string nameOf(const Candidate& candidate) {
  std::string name{allEffects()[candidate.effect].id};
  if (candidate.marker_id) name += print(" %d", *candidate.marker_id);
  if (candidate.sensor)
    name += " " + std::string(kSensorKinds.at(static_cast<std::size_t>(*candidate.sensor)));
  if (candidate.region)
    name += " " + std::string(kImageRegions.at(static_cast<std::size_t>(*candidate.region)).name);
  if (candidate.only)
    name += " of " + (candidate.only->isFirst() ? "the first" : std::string(candidate.only->name()));
  if (candidate.time_s) name += print(" at %.1f s", *candidate.time_s);
  if (candidate.peak) name += print(" around %.1f s", candidate.peak->time_s);
  for (const auto& [from_s, to_s] : candidate.active_s.parts()) {
    if (from_s > candidate.active_s.from_s) name += ",";
    if (from_s > -Interval::kForever_s) name += print(" from %.1f s", from_s);
    if (to_s < Interval::kForever_s) name += print(" to %.1f s", to_s);
  }
  return name;
}

bool isSameButTime(const Candidate& a, const Candidate& b) {
  return a.effect == b.effect && a.marker_id == b.marker_id && a.sensor == b.sensor && a.region == b.region &&
         a.only == b.only;
}

void switchOn(EffectParameters<double>& calibration, const Candidate& candidate) {
  const EffectInfo& effect = allEffects()[candidate.effect];
  calibration.on.set(effect.index);
  calibration.active_s[effect.index] = candidate.active_s;
  calibration.only[effect.index] = candidate.only;
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& p : effect.parameters) {
    if (p.kind == ParameterKind::marker_id) calibration.values[scalar] = candidate.marker_id.value_or(0);
    if (p.kind == ParameterKind::sensor) calibration.values[scalar] = candidate.sensor.value_or(0);
    if (p.kind == ParameterKind::region) calibration.values[scalar] = candidate.region.value_or(0);
    if (p.kind == ParameterKind::time) calibration.values[scalar] = candidate.time_s.value_or(0);
    if (p.kind == ParameterKind::peak_time && candidate.peak)
      calibration.values[scalar] = candidate.peak->time_s;
    if (p.kind == ParameterKind::log_width && candidate.peak)
      calibration.values[scalar] = std::log(candidate.peak->width_s / p.usual_width_s);
    scalar += static_cast<std::size_t>(p.size);
  }
}

bool actsOn(const Candidate& candidate, const RowInfo& row) {
  if (row.channel == kChannel<Prior>) return false;
  if (candidate.marker_id && row.markerSeen() != *candidate.marker_id) return false;
  if (candidate.sensor && sensorKindOf(row.channel) != *candidate.sensor) return false;
  if (candidate.region &&
      !kImageRegions.at(static_cast<std::size_t>(*candidate.region)).contains(row.image_place))
    return false;
  if (candidate.only && row.instance != *candidate.only) return false;
  if (candidate.time_s && row.t_s < *candidate.time_s) return false;
  return candidate.active_s.contains(row.t_s);
}

bool hasPeak(const EffectInfo& effect) { return effect.has(ParameterKind::peak_time); }

Peak peakOf(const EffectParameters<double>& calibration, std::size_t effect) {
  Peak peak;
  for (std::size_t s = kEffectOffsets[effect]; s < kEffectOffsets[effect + 1]; ++s) {
    const Parameter& p = parameterOf(s);
    if (p.kind == ParameterKind::peak_time) peak.time_s = calibration.values[s];
    if (p.kind == ParameterKind::log_width) peak.width_s = p.usual_width_s * std::exp(calibration.values[s]);
  }
  return peak;
}

std::vector<CandidateColumn> columnsOf(const Linearization& linear, std::size_t effect) {
  std::set<std::ptrdiff_t> images;
  if (isDrawn(effect))
    for (const RowInfo& row : linear.rows)
      if (row.patch >= 0) images.insert(row.image);
  std::vector<CandidateColumn> columns;
  for (std::size_t c = 0; c < linear.columns.size(); ++c) {
    if (linear.columns[c].effect != effect) continue;
    if (parameterOf(linear.columns[c].scalar).kind == ParameterKind::spread)
      for (const std::ptrdiff_t image : images) columns.push_back({c, image});
    else
      columns.push_back({c, -1});
  }
  return columns;
}

bool canShow(const Linearization& linear, std::size_t effect) {
  for (std::size_t c = 0; c < linear.columns.size(); ++c)
    if (linear.columns[c].effect == effect && !linear.C.col(static_cast<Eigen::Index>(c)).isZero(0))
      return true;
  return false;
}

Eigen::VectorXd priorSigmas(const Linearization& linear, const std::vector<Candidate>& candidates) {
  std::vector<double> sigmas;
  for (const Candidate& candidate : candidates)
    for (const CandidateColumn& c : columnsOf(linear, candidate.effect))
      sigmas.push_back(linear.columns[c.column].prior_sigma);
  return Eigen::Map<Eigen::VectorXd>(sigmas.data(), std::ssize(sigmas));
}

bool canBeFound(std::size_t scalar, double value, double sigma) {
  const Parameter& parameter = parameterOf(scalar);
  return parameter.kind == ParameterKind::spread || isPossible(parameter, value + kClearlySigmas * sigma);
}

/// With P taking the mean off, |P v|^2 is (K - 1) spread^2 + tr(P S P) in the mean, S the covariance of v.
EffectEstimate spreadOf(std::size_t scalar, const Eigen::VectorXd& value, const Eigen::MatrixXd& covariance) {
  const auto count = static_cast<double>(value.size());
  const double freedom = std::max(1.0, count - 1);
  const double noise = (covariance.trace() - covariance.sum() / count) / freedom;
  const double square = (value.array() - value.mean()).square().sum() / freedom;
  const double spread = std::sqrt(std::max(0.0, square - noise));
  return {effectOf(scalar), scalar, spread,
          square / std::max(spread, std::sqrt(noise)) / std::sqrt(2 * freedom)};
}

std::vector<EffectEstimate> spreadsOf(const std::vector<std::size_t>& scalars, const Eigen::VectorXd& value,
                                      const Eigen::MatrixXd& covariance) {
  std::map<std::size_t, std::vector<Eigen::Index>> columns;
  for (std::size_t k = 0; k < scalars.size(); ++k)
    columns[scalars[k]].push_back(static_cast<Eigen::Index>(k));
  std::vector<EffectEstimate> spreads;
  for (const auto& [scalar, own] : columns)
    spreads.push_back(spreadOf(scalar, value(own), covariance(own, own)));
  return spreads;
}

bool isEstimated(const Linearization& linear, std::size_t effect) {
  return std::any_of(linear.columns.begin(), linear.columns.end(),
                     [&](const EffectColumn& c) { return c.effect == effect && c.estimated; });
}

bool followsKnots(const Candidate& candidate) {
  EffectParameters<double> effects;
  switchOn(effects, candidate);
  return knotEffect(effects) == candidate.effect;
}

namespace {

/// Which of the linearization's derivatives one of the candidate's columns is of.
Eigen::Ref<const Eigen::VectorXd> derivativeBy(const Linearization& linear, const Candidate& candidate,
                                               const CandidateColumn& column) {
  if (followsKnots(candidate)) return linear.by_knots;
  return linear.C.col(static_cast<Eigen::Index>(column.column));
}

}  // namespace

Eigen::SparseMatrix<double> columnsOf(const Linearization& linear, const std::vector<Candidate>& candidates) {
  Eigen::Index count = 0, column = 0;
  for (const Candidate& candidate : candidates) count += std::ssize(columnsOf(linear, candidate.effect));
  Eigen::SparseMatrix<double> columns(std::ssize(linear.rows), count);
  for (const Candidate& candidate : candidates)
    for (const CandidateColumn& own : columnsOf(linear, candidate.effect)) {
      columns.startVec(column);
      const bool at_peak = candidate.peak && !linear.columns[own.column].on;
      const Eigen::Ref<const Eigen::VectorXd> derivative = derivativeBy(linear, candidate, own);
      for (std::size_t i = 0; i < linear.rows.size(); ++i) {
        const double value = derivative[static_cast<Eigen::Index>(i)];
        if (value == 0 || !own.has(linear.rows[i]) || !actsOn(candidate, linear.rows[i])) continue;
        const double share =
            at_peak ? shareOfPeak(linear.rows[i].t_s, candidate.peak->time_s, candidate.peak->width_s) : 1;
        columns.insertBack(static_cast<Eigen::Index>(i), column) = share * value;
      }
      ++column;
    }
  columns.finalize();
  return columns;
}

std::set<int> markersOf(const Linearization& linear) {
  std::set<int> ids;
  for (const RowInfo& row : linear.rows)
    if (row.marker_id >= 0) ids.insert(row.marker_id);
  return ids;
}

namespace {

/// Those that an effect changes.
template <class See>
void forRowsOf(const Linearization& linear, std::size_t effect, See&& see) {
  for (std::size_t c = 0; c < linear.columns.size(); ++c) {
    if (linear.columns[c].effect != effect) continue;
    const auto column = linear.C.col(static_cast<Eigen::Index>(c));
    for (std::size_t i = 0; i < linear.rows.size(); ++i)
      if (column[static_cast<Eigen::Index>(i)] != 0) see(linear.rows[i]);
  }
}

}  // namespace

std::set<Instance> instancesOf(const Linearization& linear, std::size_t effect) {
  std::set<Instance> instances;
  const bool are_several = std::any_of(linear.rows.begin(), linear.rows.end(),
                                       [](const RowInfo& row) { return !row.instance.isFirst(); });
  if (!are_several || !allEffects()[effect].is_of_instrument) return {};
  forRowsOf(linear, effect, [&](const RowInfo& row) { instances.insert(row.instance); });
  return instances.size() > 1 ? instances : std::set<Instance>();
}

std::set<int> sensorsOf(const Linearization& linear, std::size_t effect) {
  std::set<int> sensors;
  if (!allEffects()[effect].has(ParameterKind::sensor)) return sensors;
  forRowsOf(linear, effect, [&](const RowInfo& row) { sensors.insert(sensorKindOf(row.channel)); });
  return sensors;
}

std::set<int> markersOf(const Linearization& linear, std::size_t effect) {
  std::set<int> ids;
  if (!allEffects()[effect].has(ParameterKind::marker_id)) return ids;
  forRowsOf(linear, effect, [&](const RowInfo& row) {
    if (row.markerSeen() >= 0) ids.insert(row.markerSeen());
  });
  return ids;
}

std::set<int> regionsOf(const Linearization& linear, std::size_t effect) {
  std::set<int> regions;
  if (!allEffects()[effect].has(ParameterKind::region)) return regions;
  forRowsOf(linear, effect, [&](const RowInfo& row) {
    for (std::size_t r = 0; r < kImageRegions.size(); ++r)
      if (kImageRegions[r].contains(row.image_place)) regions.insert(static_cast<int>(r));
  });
  return regions;
}

std::vector<Candidate> lastingCandidates(const Linearization& linear) {
  std::vector<Candidate> candidates;
  for (const EffectInfo& effect : allEffects()) {
    if (isEstimated(linear, effect.index) || effect.has(ParameterKind::time) || hasPeak(effect)) continue;
    Candidate candidate{
        .effect = effect.index, .marker_id = {}, .time_s = {}, .peak = {}, .active_s = {}, .only = {}};
    if (effect.has(ParameterKind::sensor)) {
      for (const int sensor : sensorsOf(linear, effect.index)) {
        candidate.sensor = sensor;
        candidates.push_back(candidate);
      }
      continue;
    }
    for (const int region : regionsOf(linear, effect.index)) {
      candidate.region = region;
      candidates.push_back(candidate);
    }
    if (effect.has(ParameterKind::region)) continue;
    if (!effect.has(ParameterKind::marker_id)) candidates.push_back(candidate);
    for (const Instance& instance : instancesOf(linear, effect.index)) {
      candidates.push_back(candidate);
      candidates.back().only = instance;
    }
    for (const int id : markersOf(linear, effect.index)) {
      candidate.marker_id = id;
      candidates.push_back(candidate);
    }
  }
  return candidates;
}

}  // namespace fathom
