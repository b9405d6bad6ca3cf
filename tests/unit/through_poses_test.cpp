#include "diagnosis/through_poses.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/random.h"

namespace fathom {
namespace {

Eigen::SparseMatrix<double> sparse(const Eigen::MatrixXd& dense) { return dense.sparseView(); }

/// Six readings of two pose coordinates, behind them four of light, which take the poses as they are and tell
/// of a coordinate of the water.
struct Example {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(10, 3), taken = Eigen::MatrixXd::Zero(10, 3);
  std::vector<UnknownBlock> blocks{{UnknownBlock::Kind::pose, 0, 2, 0, 0},
                                   {UnknownBlock::Kind::water, 0, 1, 2, 0}};

  Example() {
    Random random(4);
    J.topLeftCorner(6, 2) = random.normals(6, 2);
    J.bottomRightCorner(4, 1) = random.normals(4, 1);
    taken.bottomLeftCorner(4, 2) = random.normals(4, 2);
  }
  ThroughPoses through() const { return {sparse(J), sparse(taken), blocks}; }
};

// Independent: readings as they would be, poses fitted to the six by dense least squares, light where they
// are then.
TEST(ThroughPoses, LightFollowsThePosesThatOtherReadingsSay) {
  const Example example;
  Random random(5);
  const Eigen::MatrixXd columns = random.normals(10, 3);
  const Eigen::MatrixXd followed = example.through().of(sparse(columns));
  const Eigen::MatrixXd of_poses = example.J.topLeftCorner(6, 2);
  const Eigen::MatrixXd moved =
      -(of_poses.transpose() * of_poses).inverse() * of_poses.transpose() * columns.topRows(6);
  EXPECT_TRUE(followed.topRows(6).isApprox(columns.topRows(6), 1e-12));
  EXPECT_TRUE(followed.bottomRows(4).isApprox(
      columns.bottomRows(4) + example.taken.bottomLeftCorner(4, 2) * moved, 1e-9));
}

TEST(ThroughPoses, LightMovesNoPose) {
  const Example example;
  Eigen::MatrixXd light = Eigen::MatrixXd::Zero(10, 1);
  light.bottomRows(4).setOnes();
  EXPECT_TRUE(Eigen::MatrixXd(example.through().of(sparse(light))).isApprox(light, 1e-12));
}

TEST(ThroughPoses, TransposedIsOfTheSame) {
  const Example example;
  Random random(6);
  const Eigen::MatrixXd columns = random.normals(10, 3);
  const Eigen::VectorXd v = random.normals(10, 1);
  const ThroughPoses through = example.through();
  const Eigen::VectorXd direct = Eigen::MatrixXd(through.of(sparse(columns))).transpose() * v,
                        turned = columns.transpose() * through.transposed(v);
  EXPECT_TRUE(direct.isApprox(turned, 1e-9));
}

TEST(ThroughPoses, WithoutLightNothingFollows) {
  const Example example;
  const Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(10, 1);
  const ThroughPoses none(sparse(example.J), Eigen::SparseMatrix<double>(10, 3), example.blocks);
  EXPECT_TRUE(Eigen::MatrixXd(none.of(sparse(columns))).isApprox(columns));
  EXPECT_TRUE(none.transposed(Eigen::VectorXd::Ones(10)).isApprox(Eigen::VectorXd::Ones(10)));
}

}  // namespace
}  // namespace fathom
