#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "diagnosis/whitened_model.h"
#include "estimation/batch_estimate.h"

/// All effects of the catalogue tested at once at one estimate: a score test each, with all that is estimated
/// in any case projected off.
namespace fathom {

/// A symmetric matrix's inverse on the directions that can be told from zero: with score g, g^T Q g is a
/// chi-square of `rank`. `norms`: what the columns were before the nuisances took their share.
struct Information {
  Information(const Eigen::MatrixXd& A, const Eigen::VectorXd& norms);
  Eigen::MatrixXd inverse;
  int rank = 0;
};

/// An effect tested at the model without it, to first order.
struct TestedCandidate {
  Candidate candidate;
  /// Score statistic: chi-square of `dof` where the effect is not there; 0 of one that less than nothing
  /// would have to be there of.
  double statistic = 0;
  int dof = 0;
  double log_p = 0;         ///< ln of its probability where nothing is missing, for this candidate alone
  double log_evidence = 0;  ///< ln of the odds that it is there, prior and looking elsewhere accounted for
  double size = 1;          ///< t of EffectEvidence
  double kept = 0;          ///< |P C| / |C|: what the nuisances leave of it
  std::vector<EffectEstimate> one_step;  ///< its parameters so
};

/// ln of how likely a candidate is before looking, of all that may be missing: any effect that can show is as
/// likely as any other, and of each as likely that it lasts as that it is on for a part, or from a time on:
/// one of the many between so many segments.
class PriorOdds {
 public:
  PriorOdds() = default;
  PriorOdds(const Linearization& linear, int segments);
  double logOf(const Candidate& candidate) const;

 private:
  int segments_ = 1;
  double effects_ = 1, markers_ = 1, sensors_ = 1;
  std::vector<double> instances_;  // of each effect
};

/// What is not tried: effects that have been tried in full, and did not hold on stretches that they were not
/// fitted to; and what could not, as no stretch would be left to fit it to.
struct LeftOut {
  std::set<std::size_t> parts;  ///< effects tried for good only
  std::set<std::size_t> all;    ///< not at all
  /// Parts within one of these, but for a segment: what explained it best of all did not hold.
  std::vector<Interval> during;
  double shorter_s = 0;  ///< parts that are on for less

  std::size_t count() const { return parts.size() + all.size() + during.size(); }
};

/// Candidates that are on together.
struct TestedSet {
  std::vector<std::size_t> members;  ///< in Screening::candidates()
  double log_evidence = 0;
};

class Screening {
 public:
  /// Onsets, ends and steps are tried where the recording is cut into so many equal segments. With the budget
  /// as declared: what the readings show it to be is for a fit to say.
  Screening(const WhitenedModel& model, int segments, const LeftOut& left_out = {})
      : Screening(model, model.noise().declared(), segments, left_out) {}
  /// The same under another noise.
  Screening(const WhitenedModel& model, const NoiseModel& noise, int segments, const LeftOut& left_out);

  /// Each effect (and marker) for good, then with its best interval or time.
  const std::vector<TestedCandidate>& candidates() const { return tested_; }
  /// Sets of up to `size` effects, the likeliest first; at most `count`. `log_odds`: ln of the odds against
  /// each effect besides the first.
  std::vector<TestedSet> bestSets(std::size_t size, std::size_t count, double log_odds) const;
  /// The largest |cos| between what two candidates can do to the readings, nuisances projected off.
  double alignment(std::size_t a, std::size_t b) const;
  /// How often the best of all that was tried is so likely where nothing is missing: by simulated readings
  /// that differ from the model by noise and the budget alone.
  class Chance {
   public:
    /// By Markov's inequality: odds of e^x are seen by chance e^-x as often (Ville; Vovk & Wang 2021).
    double alarmOf(double log_evidence) const {
      return std::min(1.0, kShare * std::exp(usual_best - log_evidence));
    }
    /// The evidence that is reached so often.
    double evidenceOf(double alarm) const { return usual_best + std::log(kShare / alarm); }

    static constexpr double kShare = 0.1;
    double usual_best = 0;  ///< that share of the simulated readings reach it
  };
  Chance chance(std::uint64_t seed) const;

 private:
  /// An effect's columns, segment by segment, among all.
  struct Family {
    Candidate candidate;
    std::vector<std::size_t> scalars;  ///< in EffectParameters::values
    Eigen::VectorXd prior_sigma;       ///< of each
    Eigen::MatrixXd allowed;           ///< for a part, see allowanceOf()
    Eigen::Index first = 0, size = 0;
    int segments = 1;
    bool is_step = false, has_peak = false;
    bool has_parts_only = false;  ///< as a whole it is another family
  };
  /// A run of a family's segments.
  struct Run {
    std::size_t family = 0;
    int from = 0, to = 0;  ///< the first, and the one behind the last
  };

  struct Test {
    Run run;
    Information information;
    EffectEvidence evidence;
    double log_prior = 0;
    bool is_lasting = true;
  };

  void layOut(const Linearization& linear, int segments, const LeftOut& left_out);
  void noteAllowances();
  /// Whether it is more than what the budget allows always, where it is on for a part.
  bool isBeyondAllowance(const Family& family, const Candidate& candidate, const Reduced& reduced) const;
  Eigen::SparseMatrix<double> columnsOf(const Family& family) const;
  Eigen::Index widthOf(std::size_t family) const {
    return families_[family].size * families_[family].segments;
  }
  std::vector<Run> runsOf(std::size_t family, const LeftOut& left_out) const;
  bool isLeftOut(const LeftOut& left_out, int from, int to) const;
  Candidate candidateOf(const Run& run) const;
  Candidate candidateOf(const Family& family, double from_s, double to_s) const;
  /// Of a run's segments, out of all of its family's.
  Reduced sumOver(const Run& run, const Reduced& family) const;
  Eigen::MatrixXd gramOf(std::size_t a, std::size_t b) const;
  void add(std::size_t family, TestedCandidate tested);
  void takeFinerEdges(int segments, std::vector<std::optional<TestedCandidate>>& parts);
  void combine();
  Eigen::VectorXd scoreOf(const Run& run, const Eigen::VectorXd& score) const;
  TestedCandidate test(std::size_t of_family, const Candidate& candidate, const Reduced& reduced,
                       const Information& information, const EffectEvidence& evidence) const;
  double evidenceOf(const std::vector<std::size_t>& members) const;

  WhitenedModel model_;
  PriorOdds prior_;
  Eigen::Index width_ = 0;  // of all families' columns
  double first_s_ = 0, segment_s_ = 0;
  std::vector<Family> families_;
  Reduced combined_;                 // of the tested ones, side by side
  std::vector<Eigen::Index> place_;  // of the tested ones' columns there
  std::vector<Test> all_;            // that were tried
  std::vector<TestedCandidate> tested_;
  std::vector<std::size_t> family_of_;  // of the tested ones
};

}  // namespace fathom
