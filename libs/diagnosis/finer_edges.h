#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/whitened_model.h"

namespace fathom {

/// Edges of parts of the recording between those that a screening tries. Where the poses follow an effect it
/// shows at its edges alone, and an edge that is off by an image shows nothing of it. Scores of all edges are
/// sums over the readings and cost nothing; the information, which does, is taken for that of the part whose
/// edges are the screening's own. So what seems best has to be tested again as it is.
class FinerEdges {
 public:
  /// `segments` of the span are what edges are tried at already. The model must outlive it.
  FinerEdges(const WhitenedModel& model, Interval span, int segments);

  /// Edges a segment.
  int perSegment() const { return per_segment_; }
  /// Of the candidate's columns, were it on for good, up to each edge: columns x edges.
  Eigen::MatrixXd scoresUpTo(const Candidate& lasting) const;

  /// A part and what it would be worth.
  struct Part {
    double statistic = 0;
    int from = 0, to = 0;  ///< edges
  };
  /// The best part whose edges are within half a segment of the given segments'. An edge that is the
  /// recording's stays.
  Part best(const Eigen::MatrixXd& scores, const Eigen::MatrixXd& inverse_information, int from_segment,
            int to_segment) const;

  double timeOf(int edge) const { return span_.from_s + edge * step_s_; }

 private:
  const Linearization& linear_;
  Interval span_;
  int segments_, per_segment_;
  double step_s_;
  Eigen::VectorXd share_;  // of each reading: what its derivative is multiplied by in the score
};

}  // namespace fathom
