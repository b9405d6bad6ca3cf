#include <gtest/gtest.h>

#include "core/chi_square.h"
#include "core/linear_algebra.h"
#include "support/batch_runs.h"

namespace fathom {
namespace {

// The stated covariance against the error actually made, over independent runs; and the batch estimate
// against the filter's smoother, which has the same readings.
TEST(BatchNees, CovarianceIsHonestAndTheSmootherIsBeaten) {
  constexpr int kRuns = 8;
  double nees = 0, batch_m2 = 0, smoother_m2 = 0;
  int poses = 0, compared = 0;
  std::vector<double> biases;
  for (int seed = 1; seed <= kRuns; ++seed) {
    test::BatchRun run(15.0);
    run.seed = static_cast<std::uint64_t>(seed);
    const BatchInput input = run.input();
    const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
    ASSERT_TRUE(estimate.succeeded) << estimate.failure;
    // 5 s apart errors are hardly correlated: markers tell the pose anew each second.
    for (const double t_s : {2.5, 7.5, 12.5}) {
      const PathPose& pose = estimate.path[static_cast<std::size_t>(std::lround(10 * t_s))];
      const Vector6d error = poseDifference(pose.T_odom_robot.pose, run.truth(pose.t_s));
      nees += normalizedSquare(pose.T_odom_robot.covariance, error);
      ++poses;
    }
    for (const PathPose& pose : estimate.path)
      batch_m2 += poseDifference(pose.T_odom_robot.pose, run.truth(pose.t_s)).head<3>().squaredNorm() /
                  static_cast<double>(estimate.path.size());
    for (std::size_t i = 0; i < input.start.times_s.size(); ++i, ++compared)
      smoother_m2 += poseDifference(input.start.T_odom_robot[i], run.truth(input.start.times_s[i]))
                         .head<3>()
                         .squaredNorm() /
                     static_cast<double>(input.start.times_s.size());
  }
  const auto [low, high] = meanChiSquareBand(6, static_cast<std::size_t>(poses));
  const double margin = 0.5 * (high - low);  // the 95 % band made 99.9 % wide, as there is one test
  EXPECT_GT(nees / poses, low - 0.7 * margin);
  EXPECT_LT(nees / poses, high + 0.7 * margin);
  EXPECT_LT(batch_m2, 1.05 * smoother_m2);
  RecordProperty("nees", std::to_string(nees / poses));
  RecordProperty("rms_ratio", std::to_string(std::sqrt(batch_m2 / smoother_m2)));
}

}  // namespace
}  // namespace fathom
