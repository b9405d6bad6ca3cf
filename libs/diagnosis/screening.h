#pragma once

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
  double log_p = 0;    ///< ln of its probability where nothing is missing, for this candidate alone
  double support = 0;  ///< -ln p, prior and looking elsewhere accounted for
  double kept = 0;     ///< |P C| / |C|: what the nuisances leave of it
  std::vector<EffectEstimate> one_step;  ///< its parameters so
};

/// ln of a candidate's odds against one that lasts for good, before looking: a part of the recording, or a
/// time, is one of the many between so many segments.
double logPriorOf(const Candidate& candidate, int segments);

/// How many independent tests all that was tried is worth: effects that last, and parts of the recording or
/// times, which are many. Each kind may ring half of the false alarms, or what lasts would have to be as
/// improbable as the best of a thousand intervals.
struct Looks {
  double lasting = 1, parts = 1;
};

/// Probability that, where nothing is missing, something that was tried is as improbable: that any of its
/// kind has so small a p, counted twice for the two kinds.
double alarmOf(double log_p, bool is_lasting, const Looks& looks);

/// Candidates that are on together.
struct TestedSet {
  std::vector<std::size_t> members;  ///< in Screening::candidates()
  double support = 0;
};

class Screening {
 public:
  /// Onsets, ends and steps are tried where the recording is cut into so many equal segments. The model is
  /// referred to and must outlive it.
  /// Of effects in `lasting_only` no part of the recording is tried.
  Screening(const WhitenedModel& model, int segments, const std::set<std::size_t>& lasting_only = {});

  /// Each effect (and marker) for good, then with its best interval or time.
  const std::vector<TestedCandidate>& candidates() const { return tested_; }
  /// Sets of up to `size` effects, best supported first; at most `count`. `log_odds`: ln of the odds against
  /// each effect besides the first.
  std::vector<TestedSet> bestSets(std::size_t size, std::size_t count, double log_odds) const;
  /// The largest |cos| between what two candidates can do to the readings, nuisances projected off.
  double alignment(std::size_t a, std::size_t b) const;
  /// By the medians of the least p of simulated noise.
  Looks independentLooks(std::uint64_t seed) const;

 private:
  /// An effect's columns, segment by segment, among all.
  struct Family {
    Candidate candidate;
    std::vector<std::size_t> scalars;  ///< in EffectParameters::values
    Eigen::VectorXd prior_sigma;       ///< of each
    Eigen::Index first = 0, size = 0;
    int segments = 1;
    bool is_step = false, has_peak = false;
  };
  /// A run of a family's segments.
  struct Run {
    std::size_t family = 0;
    int from = 0, to = 0;  ///< the first, and the one behind the last
  };

  struct Test {
    Run run;
    Information information;
    bool is_lasting = true;
  };

  void layOut(const Linearization& linear, int segments, const std::set<std::size_t>& lasting_only);
  Eigen::SparseMatrix<double> columns(const Linearization& linear) const;
  Eigen::VectorXd normsOf(const Run& run) const;
  std::vector<Run> runsOf(std::size_t family) const;
  Candidate candidateOf(const Run& run) const;
  Candidate candidateOf(const Family& family, double from_s, double to_s) const;
  Eigen::MatrixXd gramOf(const Run& run) const;
  Eigen::MatrixXd gramOf(std::size_t a, std::size_t b) const;
  void add(std::size_t family, TestedCandidate tested, double log_prior);
  void takeFinerEdges(int segments, std::vector<std::optional<TestedCandidate>>& parts);
  void combine();
  Eigen::VectorXd scoreOf(const Run& run, const Eigen::VectorXd& score) const;
  TestedCandidate test(std::size_t of_family, const Candidate& candidate, const Reduced& reduced,
                       const Information& information) const;
  double supportOf(const std::vector<std::size_t>& members) const;

  const WhitenedModel& model_;
  Eigen::SparseMatrix<double> columns_;  // of all families, whitened
  double first_s_ = 0, segment_s_ = 0;
  std::vector<Family> families_;
  Reduced reduced_;                  // of all segments, gram within each family only
  Reduced combined_;                 // of the tested ones, side by side
  std::vector<Eigen::Index> place_;  // of the tested ones' columns there
  std::vector<Test> all_;            // that were tried
  std::vector<TestedCandidate> tested_;
  std::vector<std::size_t> family_of_;  // of the tested ones
  std::vector<double> log_prior_;       // of the tested ones: an interval is one of many
};

/// -ln of the probability that parameters of no effect raise the likelihood so much: information A, score g.
/// With a normal prior, which keeps sizes that nobody would expect from counting, and of parameters that the
/// readings do not determine, the freedom.
double support(const Eigen::MatrixXd& A, const Eigen::VectorXd& g, const Eigen::VectorXd& prior_sigma);

}  // namespace fathom
