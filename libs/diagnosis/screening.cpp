#include "diagnosis/screening.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/chi_square.h"
#include "core/linear_algebra.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/stable_sort.h"
#include "diagnosis/allowance.h"
#include "diagnosis/constants.h"
#include "diagnosis/finer_edges.h"
#include "effects/drawn.h"
#include "effects/image_regions.h"

namespace fathom {

PriorOdds::PriorOdds(const Linearization& linear, int segments)
    : segments_(segments),
      effects_(0),
      markers_(static_cast<double>(std::max<std::size_t>(1, markersOf(linear).size()))),
      sensors_(
          static_cast<double>(std::max<std::size_t>(1, sensorsOf(linear, kEffectIndex<ClockDrift>).size()))) {
  for (const EffectInfo& effect : allEffects()) {
    effects_ += canShow(linear, effect.index);
    instances_.push_back(1 + static_cast<double>(instancesOf(linear, effect.index).size()));
  }
}

double PriorOdds::logOf(const Candidate& candidate) const {
  const double n = segments_;
  double log_prior = -std::log(std::max(1.0, effects_) * instances_.at(candidate.effect));
  if (candidate.marker_id) log_prior -= std::log(markers_);
  if (candidate.sensor) log_prior -= std::log(sensors_);
  if (candidate.region) log_prior -= std::log(static_cast<double>(kImageRegions.size()));
  if (hasPeak(allEffects()[candidate.effect])) return log_prior - std::log(0.5 * n * (n + 1));
  if (candidate.time_s) return log_prior - std::log(n);
  // An effect that is of one marker or clock, or drawn for each image, is not tried for a part.
  if (candidate.marker_id || candidate.sensor || isDrawn(candidate.effect)) return log_prior;
  const double times = candidate.isForGood() ? 0 : static_cast<double>(candidate.active_s.parts().size());
  return log_prior - std::log(2.0) - times * std::log(0.5 * n * (n + 1));
}

Information::Information(const Eigen::MatrixXd& A, const Eigen::VectorXd& norms)
    : inverse(Eigen::MatrixXd::Zero(A.rows(), A.rows())) {
  const Eigen::VectorXd unit = norms.unaryExpr([](double n) { return n > 0 ? 1 / n : 0.0; });
  const SymmetricEigen eigen = eigenOf(unit.asDiagonal() * A * unit.asDiagonal());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    if (eigen.values[i] < kLeastKept * kLeastKept) continue;
    const Eigen::VectorXd direction = unit.asDiagonal() * eigen.vectors.col(i);
    inverse += direction * direction.transpose() / eigen.values[i];
    ++rank;
  }
}

Screening::Screening(const WhitenedModel& model, const NoiseModel& noise, int segments,
                     const LeftOut& left_out)
    : model_(model.under(noise)), prior_(model.linear(), segments) {
  layOut(model_.linear(), segments, left_out);
  noteAllowances();
  // Each by itself: side by side they would take as much as a hundred times the readings.
  const Eigen::VectorXd left = model_.nuisances().project(model_.residual());
  std::vector<Reduced> each(families_.size());
  parallelFor(families_.size(), [&](std::size_t family) {
    each[family] = model_.nuisances().reduceOfLeft(columnsOf(families_[family]), left);
  });
  std::vector<std::optional<TestedCandidate>> parts;  // the best of each family
  for (std::size_t family = 0; family < families_.size(); ++family) {
    std::optional<TestedCandidate>& part = parts.emplace_back();
    for (const Run& run : runsOf(family, left_out)) {
      const Candidate candidate = candidateOf(run);
      const Reduced reduced = sumOver(run, each[family]);
      const Information information(reduced.gram, reduced.norms);
      const EffectEvidence evidence(reduced.gram, families_[family].prior_sigma);
      TestedCandidate one = test(family, candidate, reduced, information, evidence);
      if (one.dof == 0) continue;
      all_.push_back({run, information, evidence, prior_.logOf(candidate), candidate.isForGood()});
      if (candidate.isForGood())
        add(family, std::move(one));
      else if (!part || one.log_evidence > part->log_evidence)
        part = std::move(one);
    }
  }
  takeFinerEdges(segments, parts);
  for (std::size_t family = 0; family < families_.size(); ++family)
    if (parts[family]) add(family, *parts[family]);
  combine();
}

void Screening::add(std::size_t family, TestedCandidate tested) {
  tested_.push_back(std::move(tested));
  family_of_.push_back(family);
}

/// Parts with edges between the segments', where one is better by more than for having looked at so many.
void Screening::takeFinerEdges(int segments, std::vector<std::optional<TestedCandidate>>& parts) {
  const FinerEdges edges(model_, {first_s_, first_s_ + segments * segment_s_}, segments);
  std::vector<std::vector<FinerEdges::Part>> best(families_.size());
  parallelFor(families_.size(), [&](std::size_t family) {
    if (!parts[family] || families_[family].has_peak) return;
    const Eigen::MatrixXd scores = edges.scoresUpTo(families_[family].candidate);
    for (const Test& test : all_)
      if (test.run.family == family && !test.is_lasting)
        best[family].push_back(edges.best(scores, test.information.inverse, test.run.from, test.run.to));
    stableSort(best[family], [](const auto& a, const auto& b) { return a.statistic > b.statistic; });
    if (best[family].size() > kFinerTried) best[family].resize(kFinerTried);
  });
  std::vector<Candidate> candidates;
  std::vector<std::size_t> family_of;
  for (std::size_t family = 0; family < families_.size(); ++family)
    for (const FinerEdges::Part& part : best[family]) {
      candidates.push_back(candidateOf(
          families_[family], part.from > 0 ? edges.timeOf(part.from) : -Interval::kForever_s,
          part.to < segments * edges.perSegment() ? edges.timeOf(part.to) : Interval::kForever_s));
      family_of.push_back(family);
    }
  const std::vector<Reduced> reduced = model_.reduceEach(candidates);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    TestedCandidate finer =
        test(family_of[i], candidates[i], reduced[i], Information(reduced[i].gram, reduced[i].norms),
             EffectEvidence(reduced[i].gram, families_[family_of[i]].prior_sigma));
    finer.log_evidence -= std::log(edges.perSegment()) * (families_[family_of[i]].is_step ? 1 : 2);
    if (finer.dof > 0 && finer.log_evidence > parts[family_of[i]]->log_evidence)
      parts[family_of[i]] = std::move(finer);
  }
}

void Screening::noteAllowances() {
  std::vector<Family*> parted;  // that are tried for parts
  std::vector<Candidate> lasting;
  for (Family& family : families_) {
    if (family.segments == 1 || family.is_step || family.has_peak) continue;
    parted.push_back(&family);
    lasting.push_back(family.candidate);
  }
  std::vector<Eigen::MatrixXd> allowed = allowancesOf(model_, lasting);
  for (std::size_t i = 0; i < parted.size(); ++i) parted[i]->allowed = std::move(allowed[i]);
}

bool Screening::isBeyondAllowance(const Family& family, const Candidate& candidate,
                                  const Reduced& reduced) const {
  if (!comesAndGoes(candidate)) return true;
  const Eigen::MatrixXd news = newsOf(reduced.gram, family.allowed);
  const EffectEvidence evidence(news * reduced.gram, family.prior_sigma);
  return evidence.best(news * reduced.score).log_bayes_factor > kEvenOdds;
}

void Screening::combine() {
  std::vector<Candidate> candidates;
  Eigen::Index width = 0;
  for (std::size_t i = 0; i < tested_.size(); ++i) {
    candidates.push_back(tested_[i].candidate);
    place_.push_back(width);
    width += families_[family_of_[i]].size;
  }
  combined_ = model_.reduce(candidates);
}

Eigen::MatrixXd Screening::gramOf(std::size_t a, std::size_t b) const {
  return combined_.gram.block(place_[a], place_[b], families_[family_of_[a]].size,
                              families_[family_of_[b]].size);
}

void Screening::layOut(const Linearization& linear, int segments, const LeftOut& left_out) {
  const Interval span = readingsSpan(linear);
  first_s_ = span.from_s;
  segment_s_ = std::max(1e-9, (span.to_s - first_s_) / segments);
  for (const EffectInfo& effect : allEffects()) {
    const bool lasts = left_out.parts.contains(effect.index);
    if (isEstimated(linear, effect.index) || left_out.all.contains(effect.index) ||
        (lasts && (effect.has(ParameterKind::time) || hasPeak(effect))))
      continue;
    Family family;
    family.candidate.effect = effect.index;
    family.is_step = effect.has(ParameterKind::time);
    family.has_peak = hasPeak(effect);
    for (const CandidateColumn& c : fathom::columnsOf(linear, effect.index))
      family.scalars.push_back(linear.columns[c.column].scalar);
    if (family.scalars.empty()) continue;  // drawn for each image, and there is none
    family.prior_sigma = priorSigmas(linear, {family.candidate});
    const auto add = [&](std::optional<int> id, const std::optional<Instance>& only, int count) {
      family.candidate.marker_id = id;
      family.candidate.only = only;
      family.first = width_;
      family.segments = count;
      family.has_parts_only = count > 1 && followsKnots(family.candidate);
      family.size = std::ssize(family.scalars);
      width_ += family.size * count;
      families_.push_back(family);
    };
    if (effect.has(ParameterKind::marker_id)) {
      for (const int id : markersOf(linear, effect.index)) add(id, {}, 1);
      continue;
    }
    if (effect.has(ParameterKind::sensor)) {
      for (const int sensor : sensorsOf(linear, effect.index)) {
        family.candidate.sensor = sensor;
        add({}, {}, 1);
      }
      continue;
    }
    const auto regions = regionsOf(linear, effect.index);
    const int count = lasts || isDrawn(effect.index) ? 1 : segments;
    for (const int region : regions) {
      family.candidate.region = region;
      add({}, {}, count);
    }
    if (!regions.empty()) continue;
    // Of what moves the path along, a whole is not the sum of its parts.
    if (count > 1 && followsKnots(family.candidate)) add({}, {}, 1);
    add({}, {}, count);
    for (const Instance& instance : instancesOf(linear, effect.index)) add({}, instance, count);
  }
}

/// Whitened.
Eigen::SparseMatrix<double> Screening::columnsOf(const Family& family) const {
  const Linearization& linear = model_.linear();
  if (family.segments == 1) return model_.whitened(fathom::columnsOf(linear, {family.candidate}));
  const std::vector<CandidateColumn> own = fathom::columnsOf(linear, family.candidate.effect);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    if (!actsOn(family.candidate, linear.rows[i])) continue;
    const int segment =
        std::clamp(static_cast<int>((linear.rows[i].t_s - first_s_) / segment_s_), 0, family.segments - 1);
    for (Eigen::Index k = 0; k < family.size; ++k) {
      const CandidateColumn& of = own[static_cast<std::size_t>(k)];
      const double value = linear.C(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(of.column));
      if (value != 0 && of.has(linear.rows[i]))
        entries.emplace_back(static_cast<int>(i), static_cast<int>(segment * family.size + k), value);
    }
  }
  Eigen::SparseMatrix<double> columns(std::ssize(linear.rows), family.size * family.segments);
  columns.setFromTriplets(entries.begin(), entries.end());
  return model_.whitened(columns);
}

bool Screening::isLeftOut(const LeftOut& left_out, int from, int to) const {
  if ((to - from) * segment_s_ < left_out.shorter_s) return true;
  return std::any_of(left_out.during.begin(), left_out.during.end(), [&](const Interval& during) {
    return first_s_ + (from + 1) * segment_s_ >= during.from_s &&
           first_s_ + (to - 1) * segment_s_ <= during.to_s;
  });
}

std::vector<Screening::Run> Screening::runsOf(std::size_t family, const LeftOut& left_out) const {
  const Family& f = families_[family];
  std::vector<Run> runs;
  if (f.is_step) {
    for (int from = 1; from < f.segments; ++from)
      if (!isLeftOut(left_out, from, f.segments)) runs.push_back({family, from, f.segments});
    return runs;
  }
  for (int from = 0; from < f.segments; ++from)
    for (int to = from + 1; to <= f.segments; ++to)
      if (to - from == f.segments ? !f.has_peak && !f.has_parts_only
                                  : f.has_peak || !isLeftOut(left_out, from, to))
        runs.push_back({family, from, to});
  return runs;
}

Candidate Screening::candidateOf(const Run& run) const {
  const Family& family = families_[run.family];
  return candidateOf(family, run.from > 0 ? first_s_ + run.from * segment_s_ : -Interval::kForever_s,
                     run.to < family.segments ? first_s_ + run.to * segment_s_ : Interval::kForever_s);
}

Candidate Screening::candidateOf(const Family& family, double from_s, double to_s) const {
  Candidate candidate = family.candidate;
  if (family.is_step)
    candidate.time_s = from_s;
  else if (!family.has_peak)
    candidate.active_s = {from_s, to_s};
  else {  // as much, and as high
    const double last_s = first_s_ + family.segments * segment_s_;
    from_s = std::max(from_s, first_s_);
    to_s = std::min(to_s, last_s);
    candidate.peak = {0.5 * (from_s + to_s), (to_s - from_s) / std::sqrt(2 * std::numbers::pi)};
  }
  return candidate;
}

Reduced Screening::sumOver(const Run& run, const Reduced& family) const {
  const Eigen::Index size = families_[run.family].size;
  Reduced sum{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)};
  for (int i = run.from; i < run.to; ++i) {
    for (int j = run.from; j < run.to; ++j) sum.gram += family.gram.block(i * size, j * size, size, size);
    sum.score += family.score.segment(i * size, size);
    sum.norms.array() += family.norms.segment(i * size, size).array().square();
  }
  sum.norms = sum.norms.cwiseSqrt();
  return sum;
}

Eigen::VectorXd Screening::scoreOf(const Run& run, const Eigen::VectorXd& score) const {
  const Family& family = families_[run.family];
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(family.size);
  for (int i = run.from; i < run.to; ++i) sum += score.segment(family.first + i * family.size, family.size);
  return sum;
}

TestedCandidate Screening::test(std::size_t of_family, const Candidate& candidate, const Reduced& reduced,
                                const Information& information, const EffectEvidence& evidence) const {
  const Family& family = families_[of_family];
  TestedCandidate tested;
  tested.candidate = candidate;
  tested.dof = information.rank;
  if (tested.dof == 0) return tested;
  tested.kept = std::sqrt(std::max(0.0, reduced.gram.trace()) / reduced.norms.squaredNorm());
  // The residual is reading - prediction to first order in -C: what lowers it is -value.
  const EffectEvidence::Best best = evidence.best(reduced.score);
  const Eigen::VectorXd value = evidence.valueAt(reduced.score, best.size);
  bool is_possible = true;
  for (Eigen::Index k = 0; k < family.size; ++k) {
    const std::size_t scalar = family.scalars[static_cast<std::size_t>(k)];
    tested.one_step.push_back(
        {family.candidate.effect, scalar, value[k], std::sqrt(information.inverse(k, k))});
    is_possible = is_possible && canBeFound(scalar, value[k], tested.one_step.back().sigma);
  }
  if (isDrawn(candidate.effect)) tested.one_step = spreadsOf(family.scalars, value, information.inverse);
  if (is_possible && best.log_bayes_factor > kEvenOdds)
    is_possible = isBeyondAllowance(family, candidate, reduced);
  tested.size = best.size;
  tested.log_evidence = prior_.logOf(candidate) + (is_possible ? best.log_bayes_factor : kImpossible);
  if (is_possible) tested.statistic = reduced.score.dot(information.inverse * reduced.score);
  tested.log_p = chiSquareLogTail(tested.dof, tested.statistic);
  return tested;
}

double Screening::evidenceOf(const std::vector<std::size_t>& members) const {
  Eigen::Index size = 0;
  for (const std::size_t m : members) size += families_[family_of_[m]].size;
  Eigen::MatrixXd A(size, size);
  Eigen::VectorXd g(size), sigma(size);
  std::vector<double> sizes;
  double prior = 0;
  Eigen::Index row = 0;
  for (const std::size_t a : members) {
    const Eigen::Index rows = families_[family_of_[a]].size;
    Eigen::Index column = 0;
    for (const std::size_t b : members) {
      const Eigen::Index columns = families_[family_of_[b]].size;
      A.block(row, column, rows, columns) = gramOf(a, b);
      column += columns;
    }
    g.segment(row, rows) = combined_.score.segment(place_[a], rows);
    sigma.segment(row, rows) = tested_[a].size * families_[family_of_[a]].prior_sigma;
    sizes.push_back(tested_[a].size);
    prior += prior_.logOf(tested_[a].candidate);
    row += rows;
  }
  return logBayesFactorOf(A, g, sigma, sizes) + prior;
}

std::vector<TestedSet> Screening::bestSets(std::size_t size, std::size_t count, double log_odds) const {
  std::vector<TestedSet> all, latest{{{}, 0}};
  const auto byEvidence = [](const TestedSet& a, const TestedSet& b) {
    return a.log_evidence > b.log_evidence;
  };
  for (std::size_t k = 1; k <= size; ++k) {
    std::set<std::vector<std::size_t>> grown;
    for (const TestedSet& set : latest)
      for (std::size_t m = 0; m < tested_.size(); ++m) {
        const bool there = std::any_of(set.members.begin(), set.members.end(), [&](std::size_t other) {
          return tested_[other].candidate.effect == tested_[m].candidate.effect;
        });
        if (there) continue;
        std::vector<std::size_t> members = set.members;
        members.insert(std::upper_bound(members.begin(), members.end(), m), m);
        grown.insert(std::move(members));
      }
    latest.clear();
    for (const auto& members : grown) latest.push_back({members, 0});
    parallelFor(latest.size(),
                [&](std::size_t i) { latest[i].log_evidence = evidenceOf(latest[i].members); });
    stableSort(latest, byEvidence);
    if (latest.size() > kKeptSets) latest.resize(kKeptSets);
    for (const TestedSet& set : latest)
      all.push_back({set.members, set.log_evidence - log_odds * static_cast<double>(k - 1)});
  }
  stableSort(all, byEvidence);
  if (all.size() > count) all.resize(count);
  return all;
}

double Screening::alignment(std::size_t a, std::size_t b) const {
  const auto root = [&](std::size_t m) {
    const SymmetricEigen eigen = eigenOf(gramOf(m, m));
    const double least = kLeastKept * kLeastKept * eigen.values.maxCoeff();
    const Eigen::VectorXd inverse =
        eigen.values.unaryExpr([&](double l) { return l > least ? 1 / std::sqrt(l) : 0.0; });
    return Eigen::MatrixXd(eigen.vectors * inverse.asDiagonal());
  };
  const Eigen::MatrixXd cosines = root(a).transpose() * gramOf(a, b) * root(b);
  return std::min(1.0, largestSingularValue(cosines));
}

Screening::Chance Screening::chance(std::uint64_t seed) const {
  if (all_.empty()) return {};
  Random random(seed);
  Eigen::MatrixXd left(model_.residual().size(), kAlarmDraws);
  for (int draw = 0; draw < kAlarmDraws; draw += kDrawsAtOnce)
    left.middleCols(draw, kDrawsAtOnce) =
        model_.nuisances().project(random.normals(left.rows(), kDrawsAtOnce));
  Eigen::MatrixXd scores(width_, kAlarmDraws);
  parallelFor(families_.size(), [&](std::size_t family) {
    scores.middleRows(families_[family].first, widthOf(family)) =
        columnsOf(families_[family]).transpose() * left;
  });
  std::vector<double> best(kAlarmDraws, kImpossible);
  parallelFor(kAlarmDraws, [&](int draw) {
    const Eigen::VectorXd score = scores.col(draw);
    double& own = best[static_cast<std::size_t>(draw)];
    for (const Test& test : all_)
      own = std::max(own, test.log_prior + test.evidence.best(scoreOf(test.run, score)).log_bayes_factor);
  });
  std::sort(best.begin(), best.end());
  const auto reached = static_cast<std::size_t>((1 - Chance::kShare) * static_cast<double>(best.size()));
  return {best[reached]};
}

}  // namespace fathom
