#include "diagnosis/candidate.h"

#include <algorithm>

#include "core/text.h"
#include "effects/catalogue.h"

namespace fathom {

std::string nameOf(const Candidate& candidate) {
  std::string name{allEffects()[candidate.effect].id};
  if (candidate.marker_id) name += print(" %d", *candidate.marker_id);
  if (candidate.time_s) name += print(" at %.1f s", *candidate.time_s);
  if (candidate.active_s.from_s > -Interval::kForever_s)
    name += print(" from %.1f s", candidate.active_s.from_s);
  if (candidate.active_s.to_s < Interval::kForever_s) name += print(" to %.1f s", candidate.active_s.to_s);
  return name;
}

void switchOn(EffectParameters<double>& calibration, const Candidate& candidate) {
  const EffectInfo& effect = allEffects()[candidate.effect];
  calibration.on.set(effect.index);
  calibration.active_s[effect.index] = candidate.active_s;
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& p : effect.parameters) {
    if (p.kind == ParameterKind::marker_id) calibration.values[scalar] = candidate.marker_id.value_or(0);
    if (p.kind == ParameterKind::time) calibration.values[scalar] = candidate.time_s.value_or(0);
    scalar += static_cast<std::size_t>(p.size);
  }
}

bool actsOn(const Candidate& candidate, const RowInfo& row) {
  if (row.channel == BatchChannel::prior) return false;
  if (candidate.marker_id && row.marker_id != *candidate.marker_id) return false;
  if (candidate.time_s && row.t_s < *candidate.time_s) return false;
  return candidate.active_s.contains(row.t_s);
}

std::vector<std::size_t> columnsOf(const Linearization& linear, std::size_t effect) {
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < linear.columns.size(); ++c)
    if (linear.columns[c].effect == effect) columns.push_back(c);
  return columns;
}

Eigen::VectorXd priorSigmas(const Linearization& linear, const std::vector<Candidate>& candidates) {
  std::vector<double> sigmas;
  for (const Candidate& candidate : candidates)
    for (const std::size_t c : columnsOf(linear, candidate.effect))
      sigmas.push_back(linear.columns[c].prior_sigma);
  return Eigen::Map<Eigen::VectorXd>(sigmas.data(), std::ssize(sigmas));
}

bool isEstimated(const Linearization& linear, std::size_t effect) {
  return std::any_of(linear.columns.begin(), linear.columns.end(),
                     [&](const EffectColumn& c) { return c.effect == effect && c.estimated; });
}

Eigen::SparseMatrix<double> columnsOf(const Linearization& linear, const std::vector<Candidate>& candidates) {
  std::vector<Eigen::Triplet<double>> entries;
  int column = 0;
  for (const Candidate& candidate : candidates)
    for (const std::size_t c : columnsOf(linear, candidate.effect)) {
      for (std::size_t i = 0; i < linear.rows.size(); ++i) {
        const double value = linear.C(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c));
        if (value != 0 && actsOn(candidate, linear.rows[i]))
          entries.emplace_back(static_cast<int>(i), column, value);
      }
      ++column;
    }
  Eigen::SparseMatrix<double> columns(std::ssize(linear.rows), column);
  columns.setFromTriplets(entries.begin(), entries.end());
  return columns;
}

}  // namespace fathom
