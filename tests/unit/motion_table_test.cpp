#include "estimation/motion_table.h"

#include <gtest/gtest.h>

#include "estimation/batch_problem.h"
#include "support/batch_runs.h"

namespace fathom {
namespace {

TEST(MotionTable, EqualNodesHaveOneNumber) {
  MotionTable table;
  EXPECT_EQ(table.add({3, 4, 0.25}), 0);
  EXPECT_EQ(table.add({3, 4, 0.5}), 1);
  EXPECT_EQ(table.add({4, 4, 0.25}), 2);
  EXPECT_EQ(table.add({3, 1, 0.25}), 3);
  EXPECT_EQ(table.add({3, 4, 0.25}), 0);
  EXPECT_EQ(table.node(2), (MotionNode{4, 4, 0.25}));
}

TEST(MotionTable, MotionsAreThoseOfTheNodes) {
  PosePath path{0.0, 0.2, {}};
  for (int i = 0; i < 6; ++i)
    path.poses.push_back({expSO3<double>(0.1 * i * Vector3d(0.3, 0.1, -0.5)), Vector3d(i, -i, 0.1 * i * i)});
  const std::vector<MotionNode> nodes{{0, 4, 0.3}, {2, 4, 0.9}, {5, 1, 0.0}, {0, 0, 0.0}};
  MotionTable table;
  for (const MotionNode& node : nodes) table.add(node);
  const Motions motions = table.at(path, true);
  ASSERT_EQ(motions.values.size(), nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Motion expected = motionOf(path, nodes[i]);
    EXPECT_EQ(motions.values[i].T_odom_robot.position, expected.T_odom_robot.position);
    EXPECT_EQ(motions.values[i].rate_second_derivative_robot, expected.rate_second_derivative_robot);
    EXPECT_EQ(motions.derivatives[i], motionJacobian(path, nodes[i]));
  }
  EXPECT_TRUE(table.at(path, false).derivatives.empty());
}

// What makes the table worth while.
TEST(MotionTable, GyroAndAccelerometerShareTheirMotions) {
  const BatchInput input = test::BatchRun(3.0).input();
  const BatchState state = startState(input.data, input.start.times_s, input.start.T_odom_robot, {}, 10.0);
  const auto motions = [&](const BatchData& data) {
    const BatchProblem problem(data, {}, state);
    return problem.pointAt(Eigen::VectorXd::Zero(problem.unknowns()), false).motions.values.size();
  };
  BatchData without_force = input.data;
  without_force.of<Accelerometer>().clear();
  ASSERT_FALSE(input.data.of<Accelerometer>().empty());
  EXPECT_EQ(motions(input.data), motions(without_force));
}

}  // namespace
}  // namespace fathom
