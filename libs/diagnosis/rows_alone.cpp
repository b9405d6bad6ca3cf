#include "diagnosis/rows_alone.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "core/linear_algebra.h"
#include "diagnosis/constants.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

/// The nuisances of some rows, each held a little: a stretch by itself may not determine them all.
Nuisances nuisancesOf(const Nuisances& all, const std::vector<Eigen::Index>& rows) {
  const Eigen::SparseMatrix<double>& J = all.J();
  Nuisances::AtEnd at_end;
  const Eigen::Index first_full = J.cols() - all.atEnd().full, first_local = first_full - all.atEnd().local;
  std::vector<int> place(static_cast<std::size_t>(J.rows()), -1);
  for (std::size_t k = 0; k < rows.size(); ++k)
    place[static_cast<std::size_t>(rows[k])] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> lengths;
  for (Eigen::Index c = 0; c < J.outerSize(); ++c) {
    const int column = static_cast<int>(lengths.size());
    double square = 0;
    for (Eigen::SparseMatrix<double>::InnerIterator e(J, c); e; ++e) {
      if (place[static_cast<std::size_t>(e.row())] < 0) continue;
      entries.emplace_back(place[static_cast<std::size_t>(e.row())], column, e.value());
      square += e.value() * e.value();
    }
    if (square == 0) continue;
    lengths.push_back(std::sqrt(square));
    at_end.local += c >= first_local && c < first_full;
    at_end.full += c >= first_full;
  }
  const int first = static_cast<int>(rows.size()), width = static_cast<int>(lengths.size());
  for (int c = 0; c < width; ++c)
    entries.emplace_back(first + c, c, kRidge * lengths[static_cast<std::size_t>(c)]);
  Eigen::SparseMatrix<double> own(first + width, width);
  own.setFromTriplets(entries.begin(), entries.end());
  return {own, at_end};
}

}  // namespace

RowsAlone::RowsAlone(const WhitenedModel& model, std::vector<Eigen::Index> rows)
    : rows_(std::move(rows)),
      nuisances_(nuisancesOf(model.nuisances(), rows_)),
      residual_(own(Eigen::MatrixXd(model.residual()))) {}

Eigen::SparseMatrix<double> RowsAlone::own(const Eigen::SparseMatrix<double>& columns) const {
  Eigen::SparseMatrix<double> all = rowsOf(columns, rows_);
  all.conservativeResize(nuisances_.J().rows(), all.cols());
  return all;
}

Eigen::MatrixXd RowsAlone::own(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(nuisances_.J().rows(), columns.cols());
  all.topRows(std::ssize(rows_)) = columns(rows_, Eigen::all);
  return all;
}

Reduced RowsAlone::reduce(const Eigen::SparseMatrix<double>& columns) const {
  return nuisances_.reduce(own(columns), residual_);
}

std::vector<Reduced> RowsAlone::reduceEach(const Eigen::SparseMatrix<double>& columns,
                                           const std::vector<Eigen::Index>& sizes) const {
  return nuisances_.reduceEach(own(columns), residual_, sizes);
}

Eigen::MatrixXd RowsAlone::scores(const Eigen::SparseMatrix<double>& columns,
                                  const Eigen::MatrixXd& R) const {
  return nuisances_.scores(own(columns), own(R));
}

Eigen::MatrixXd RowsAlone::project(const Eigen::MatrixXd& R) const {
  return nuisances_.project(own(R)).topRows(std::ssize(rows_));
}

Eigen::VectorXd fitted(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                       const Eigen::VectorXd& prior_sigma, const std::vector<bool>& is_positive) {
  Eigen::MatrixXd A = gram;
  A.diagonal() += prior_sigma.array().square().inverse().matrix();
  std::vector<Eigen::Index> free(static_cast<std::size_t>(score.size()));
  std::iota(free.begin(), free.end(), Eigen::Index{0});
  Eigen::VectorXd value = Eigen::VectorXd::Zero(score.size());
  for (std::size_t held = 1; held > 0 && !free.empty();) {
    value.setZero();
    value(free) = -solveSymmetric(Eigen::MatrixXd(A(free, free)), Eigen::VectorXd(score(free)));
    held = std::erase_if(free, [&](Eigen::Index k) {
      return !is_positive.empty() && is_positive[static_cast<std::size_t>(k)] && value[k] < 0;
    });
  }
  return value;
}

}  // namespace fathom
