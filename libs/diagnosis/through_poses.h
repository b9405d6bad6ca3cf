#pragma once

#include <Eigen/SparseCore>
#include <memory>

#include "estimation/linearization.h"
#include "estimation/nuisances.h"

namespace fathom {

/// What changes the readings changes light through the poses, too: a panel that is stretched moves the robot,
/// and from elsewhere light has another way through the water. Light is no judge of poses
/// (BatchProblem::addPatches), so it is taken to follow where the other readings say they are, by least
/// squares (a cut: Plummer 2015); no nuisance says it a second time. Without that a dive's light differs by
/// some 1e-4 for the panel's sake alone, and all of it together resolves a tenth of that.
class ThroughPoses {
 public:
  ThroughPoses() = default;  ///< nothing follows
  /// J, taken: of a linearization with these unknowns.
  ThroughPoses(const Eigen::SparseMatrix<double>& J, const Eigen::SparseMatrix<double>& taken,
               const std::vector<UnknownBlock>& blocks);

  /// Columns over the linearization's rows, with what they do to light so; less than a thousandth of what
  /// they do to all readings is left out.
  Eigen::SparseMatrix<double> of(const Eigen::SparseMatrix<double>& columns) const;
  /// The transposed of that, of one vector: of(C)^T v = C^T transposed(v).
  Eigen::VectorXd transposed(const Eigen::VectorXd& v) const;

 private:
  struct Places {
    Places(const Eigen::SparseMatrix<double>& J, const Eigen::SparseMatrix<double>& by_taken)
        : nuisances(J), taken(by_taken) {}
    /// Columns with what follows; `along`: J^T of them.
    Eigen::SparseMatrix<double> of(const Eigen::SparseMatrix<double>& columns,
                                   const Eigen::SparseMatrix<double>& along) const;

    Nuisances nuisances;                                 ///< unknowns that say where everything is
    Eigen::SparseMatrix<double, Eigen::RowMajor> taken;  ///< by those
  };
  std::shared_ptr<const Places> places_;  // none: nothing follows
};

}  // namespace fathom
