#include "diagnosis/rows_alone.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace fathom {
namespace {

constexpr double kRidge = 1e-4;  // of a column's length, where a stretch by itself says nothing

/// The nuisances of some rows, each held a little: a stretch by itself may not determine them all.
Nuisances nuisancesOf(const Eigen::SparseMatrix<double>& J, const std::vector<Eigen::Index>& rows) {
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
    if (square > 0) lengths.push_back(std::sqrt(square));
  }
  const int first = static_cast<int>(rows.size()), width = static_cast<int>(lengths.size());
  for (int c = 0; c < width; ++c)
    entries.emplace_back(first + c, c, kRidge * lengths[static_cast<std::size_t>(c)]);
  Eigen::SparseMatrix<double> own(first + width, width);
  own.setFromTriplets(entries.begin(), entries.end());
  return Nuisances(own);
}

}  // namespace

RowsAlone rowsAlone(const WhitenedModel& model, std::vector<Eigen::Index> rows,
                    const Eigen::MatrixXd& columns, const Eigen::MatrixXd& noise) {
  const Nuisances nuisances = nuisancesOf(model.nuisances().J(), rows);
  const auto projected = [&](const Eigen::MatrixXd& all) {
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(nuisances.J().rows(), all.cols());
    own.topRows(std::ssize(rows)) = all(rows, Eigen::all);
    return Eigen::MatrixXd(nuisances.project(own).topRows(std::ssize(rows)));
  };
  RowsAlone part;
  part.residual = projected(model.residual());
  part.columns = projected(columns);
  part.noise = projected(noise);
  part.rows = std::move(rows);
  return part;
}

Eigen::VectorXd fitted(const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual,
                       const Eigen::VectorXd& sigma) {
  if (columns.cols() == 0) return {};
  Eigen::MatrixXd A = columns.transpose() * columns;
  A.diagonal() += sigma.array().square().inverse().matrix();
  return -A.ldlt().solve(columns.transpose() * residual);
}

}  // namespace fathom
