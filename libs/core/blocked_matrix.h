#pragma once

#include <vector>

#include "core/linear_algebra.h"

namespace fathom {

/// A symmetric matrix of many unknowns, most of which have to do with a few others of their kind and with
/// those of a border that all may share: D of blocks beside each other, B across to the border, C within it.
/// Whatever the unknowns' order: what goes in and comes out is by theirs.
struct BlockedMatrix {
  std::vector<std::vector<Eigen::Index>> members;  ///< of each block
  std::vector<Eigen::Index> border;                ///< the others, ascending
  std::vector<Eigen::MatrixXd> blocks;
  Eigen::MatrixXd across;  ///< rows: the blocks' members one behind the other
  Eigen::MatrixXd within;

  BlockedMatrix() = default;
  /// All of it border.
  BlockedMatrix(Eigen::MatrixXd all);  // NOLINT: a matrix of no blocks

  Eigen::Index size() const { return across.rows() + std::ssize(border); }
  /// Of so many unknowns, the last: which are in the border.
  Eigen::MatrixXd lastColumns(Eigen::Index count) const;
};

/// 1 + S A S = L L^T, of unknowns in units of the sigma that holds them. An infinite sigma holds nothing:
/// there the 1 is left out, and the unit is what makes A's diagonal 1.
class BlockedFactors {
 public:
  BlockedFactors(const BlockedMatrix& A, const Eigen::VectorXd& sigma);

  bool succeeded() const { return succeeded_; }
  const Eigen::VectorXd& units() const { return units_; }  ///< S
  double logDeterminant() const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  Eigen::MatrixXd inverse() const;
  Eigen::VectorXd inverseDiagonal() const;

 private:
  /// Each block's L^-1 x, or L^-T x.
  void solveBlocks(Eigen::MatrixXd& x, bool transposed) const;
  /// What D^-1 leaves out of the inverse's part of the blocks is G^T G.
  Eigen::MatrixXd beyondBlocks() const;

  std::vector<Eigen::Index> inner_, border_;
  Eigen::VectorXd units_;
  std::vector<Eigen::MatrixXd> L_;  // of the blocks
  Eigen::MatrixXd across_;          // L^-1 B
  PositiveFactors last_;            // of what they leave of C
  bool succeeded_ = true;
};

}  // namespace fathom
