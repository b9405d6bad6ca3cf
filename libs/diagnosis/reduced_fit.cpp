#include "diagnosis/reduced_fit.h"

#include <map>
#include <numeric>

#include "core/linear_algebra.h"
#include "diagnosis/constants.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

/// Of columns those together that have readings in common; what has them with more than a block may have is
/// in none.
std::vector<std::vector<Eigen::Index>> blocksOf(const Eigen::SparseMatrix<double>& columns,
                                                const std::vector<Eigen::Index>& local) {
  std::vector<std::size_t> parent(local.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto rootOf = [&](std::size_t k) {
    while (parent[k] != k) k = parent[k] = parent[parent[k]];
    return k;
  };
  std::vector<std::ptrdiff_t> first(static_cast<std::size_t>(columns.rows()), -1);
  for (std::size_t k = 0; k < local.size(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator e(columns, local[k]); e; ++e) {
      std::ptrdiff_t& own = first[static_cast<std::size_t>(e.row())];
      if (own < 0)
        own = static_cast<std::ptrdiff_t>(k);
      else
        parent[rootOf(k)] = rootOf(static_cast<std::size_t>(own));
    }
  std::map<std::size_t, std::vector<Eigen::Index>> by_root;
  for (std::size_t k = 0; k < local.size(); ++k) by_root[rootOf(k)].push_back(local[k]);
  std::vector<std::vector<Eigen::Index>> blocks;
  for (auto& [root, own] : by_root)
    if (own.size() <= kLargestBlock) blocks.push_back(std::move(own));
  return blocks;
}

/// C^T P C, of which the blocks' columns have nothing in common with the nuisances.
BlockedMatrix blockedGram(const Nuisances& nuisances, const Eigen::SparseMatrix<double>& columns,
                          std::vector<std::vector<Eigen::Index>> blocks) {
  BlockedMatrix gram;
  std::vector<bool> is_inner(static_cast<std::size_t>(columns.cols()), false);
  std::vector<Eigen::Index> inner;
  for (const std::vector<Eigen::Index>& own : blocks) {
    gram.blocks.push_back(denseGramOf(columnsOf(columns, own)));
    for (const Eigen::Index k : own) {
      is_inner[static_cast<std::size_t>(k)] = true;
      inner.push_back(k);
    }
  }
  gram.members = std::move(blocks);
  for (Eigen::Index k = 0; k < columns.cols(); ++k)
    if (!is_inner[static_cast<std::size_t>(k)]) gram.border.push_back(k);
  const Eigen::SparseMatrix<double> border = columnsOf(columns, gram.border);
  gram.within = nuisances.gram(border);
  gram.across = transposedTimes(columnsOf(columns, inner), border);
  return gram;
}

}  // namespace

ReducedFit::Shared::Shared(const Bare& bare, const HeldColumns& budget) {
  for (const UnknownBlock& block : bare.blocks) {
    using enum UnknownBlock::Kind;
    auto& own = block.kind == water || block.kind == flaws ? of_light : of_others;
    for (int k = 0; k < block.size; ++k) own.push_back(block.column + k);
  }
  others = columnsOf(bare.J, of_others);
  const Eigen::SparseMatrix<double> along =
      transposedTimes(others, columnsOf(budget.columns, budget.of_places));
  for (std::size_t k = 0; k < budget.of_places.size(); ++k)
    if (along.col(static_cast<Eigen::Index>(k)).nonZeros() == 0) local.push_back(budget.of_places[k]);
  if (local.empty()) {
    of_light.clear();
    of_others.resize(static_cast<std::size_t>(bare.J.cols()));
    std::iota(of_others.begin(), of_others.end(), Eigen::Index{0});
    others = bare.J;
  }
  shared = columnsOf(bare.J, of_light);
}

ReducedFit::ReducedFit(const Linearization& linear, const std::vector<Candidate>& effects,
                       const BatchState& state, const NoiseModel& noise, const HeldColumns& budget)
    : unknowns_(linear.J.cols()),
      bare_(bareOf(linear, effects, state)),
      budget_(budget),
      shared_(bare_, budget),
      columns_(sideBySide({bare_.through.of(budget.columns), shared_.shared, bare_.columns}, bare_.J.rows())),
      W_(linear, noise),
      nuisances_(W_ * shared_.others),
      residual_(W_ * bare_.residual),
      left_(nuisances_.project(residual_)) {
  const Eigen::SparseMatrix<double> whitened = W_ * columns_;
  gram_ = blockedGram(nuisances_, whitened, blocksOf(whitened, shared_.local));
  score_ = whitened.transpose() * left_;
}

Split ReducedFit::split(const Eigen::VectorXd& sigma, const Eigen::VectorXd& usual,
                        const std::vector<Eigen::Index>& widths) const {
  const Eigen::Index p = usual.size(), q = score_.size() - p;
  Eigen::VectorXd of_budget = sigma;
  of_budget.tail(p).setZero();
  const BlockedFactors M(gram_, of_budget);
  if (!M.succeeded()) throw Singular("readings weigh more than rounding");
  const Eigen::VectorXd g = M.units().cwiseProduct(score_);
  const Eigen::MatrixXd of_effects = gram_.lastColumns(p), B = M.units().asDiagonal() * of_effects;
  const Eigen::MatrixXd MB = M.solve(B);
  Split split;
  split.of_budget = 0.5 * (g.dot(M.solve(g).col(0)) - M.logDeterminant());
  split.gram = of_effects.bottomRows(p) - transposedTimes(B, MB);
  split.score = score_.tail(p) - MB.transpose() * g;
  split.effects = bestSizes(split.gram, split.score, usual, widths);
  const Eigen::VectorXd beside = g + B * split.effects.evidence.value;
  split.budget = -M.units().cwiseProduct(M.solve(beside).col(0)).head(q);
  return split;
}

double ReducedFit::logEvidence(const Split& split) const {
  const Eigen::Index first = gram_.within.rows() - bare_.columns.cols() - unheld();
  const BlockedFactors own(Eigen::MatrixXd(gram_.within.block(first, first, unheld(), unheld())),
                           Eigen::VectorXd::Constant(unheld(), kUnheld));
  return 0.5 * (own.logDeterminant() - left_.squaredNorm()) + split.of_budget;
}

Eigen::VectorXd ReducedFit::change(const Split& split) const {
  Eigen::VectorXd values(columns_.cols());
  values << split.budget, split.effects.evidence.value;
  return columns_ * values;
}

Eigen::VectorXd ReducedFit::leftBy(const Split& split) const {
  const Eigen::VectorXd changed = change(split);
  return bare_.residual + changed + shared_.others * nuisances_.step(residual_ + W_ * changed);
}

Eigen::VectorXd ReducedFit::stepBy(const Split& split) const {
  Eigen::VectorXd step = Eigen::VectorXd::Zero(unknowns_);
  const auto take = [&](const std::vector<Eigen::Index>& own, const Eigen::VectorXd& by) {
    for (std::size_t k = 0; k < own.size(); ++k)
      step[bare_.unknowns[static_cast<std::size_t>(own[k])]] = by[static_cast<Eigen::Index>(k)];
  };
  take(shared_.of_others, nuisances_.step(residual_ + W_ * change(split)));
  take(shared_.of_light, split.budget.tail(unheld()));
  return step;
}

}  // namespace fathom
