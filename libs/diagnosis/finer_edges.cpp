#include "diagnosis/finer_edges.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/constants.h"

namespace fathom {

FinerEdges::FinerEdges(const WhitenedModel& model, Interval span, int segments)
    : linear_(model.linear()), span_(span), segments_(segments), share_(model.scoreShares()) {
  const double segment_s = (span.to_s - span.from_s) / segments;
  per_segment_ = std::clamp(static_cast<int>(std::ceil(segment_s / kEdge_s)), 1, kMostPerSegment);
  step_s_ = std::max(1e-9, segment_s / per_segment_);
}

Eigen::MatrixXd FinerEdges::scoresUpTo(const Candidate& lasting) const {
  const std::vector<CandidateColumn> own = columnsOf(linear_, lasting.effect);
  const int last = segments_ * per_segment_;
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(std::ssize(own), last + 1);
  for (std::size_t i = 0; i < linear_.rows.size(); ++i) {
    if (!actsOn(lasting, linear_.rows[i])) continue;
    const auto row = static_cast<Eigen::Index>(i);
    const int edge =
        std::clamp(1 + static_cast<int>(std::floor((linear_.rows[i].t_s - span_.from_s) / step_s_)), 1, last);
    for (std::size_t k = 0; k < own.size(); ++k)
      if (own[k].has(linear_.rows[i]))
        scores(static_cast<Eigen::Index>(k), edge) +=
            linear_.C(row, static_cast<Eigen::Index>(own[k].column)) * share_[row];
  }
  for (int edge = 1; edge <= last; ++edge) scores.col(edge) += scores.col(edge - 1);
  return scores;
}

FinerEdges::Part FinerEdges::best(const Eigen::MatrixXd& scores, const Eigen::MatrixXd& inverse_information,
                                  int from_segment, int to_segment) const {
  const auto around = [&](int segment) {
    const int edge = segment * per_segment_, half = per_segment_ / 2;
    const bool stays = segment == 0 || segment == segments_;
    return std::pair{stays ? edge : edge - half, stays ? edge : edge + half};
  };
  const auto [first_from, last_from] = around(from_segment);
  const auto [first_to, last_to] = around(to_segment);
  Part best;
  for (int from = first_from; from <= last_from; ++from)
    for (int to = std::max(from + 1, first_to); to <= last_to; ++to) {
      const Eigen::VectorXd g = scores.col(to) - scores.col(from);
      const double statistic = g.dot(inverse_information * g);
      if (statistic > best.statistic) best = {statistic, from, to};
    }
  return best;
}

}  // namespace fathom
