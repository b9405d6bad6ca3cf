// Errors against a reference that has a frame of its own.
#include "localization/evaluation.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

Estimate estimateAt(double t_s, const Pose& pose, const FrameCoordinates& defined) {
  Estimate estimate;
  estimate.time = after(Time{}, t_s);
  estimate.t_s = t_s;
  estimate.state.motion.R_odom_robot = pose.rotation;
  estimate.state.motion.position_odom = pose.position;
  estimate.pose_covariance.setIdentity();
  estimate.defined = defined;
  return estimate;
}

Pose walk(double t_s) {
  return {rotationFromYawPitchRoll(0.2 * t_s, 0.1, -0.05), {t_s, std::sin(t_s), -3.0}};
}

TEST(Evaluation, LaysTheReferenceOnAFrameThatIsADefinition) {
  const Pose T_defined_reference{rotationFromYawPitchRoll(-2.0, 0, 0), {40.0, -3.0, 0.0}};
  std::vector<StampedPose> reference;
  for (int i = 0; i <= 20; ++i) reference.push_back({after(Time{}, 0.5 * i), walk(0.5 * i)});
  const FrameCoordinates told{}, defined{true, false, true};
  Evaluator evaluator(reference);
  for (int i = 0; i < 10; ++i)
    EXPECT_TRUE(evaluator.add(estimateAt(0.5 * i, T_defined_reference * walk(0.5 * i), defined)));
  // The first fix has moved the frame to the reference's.
  for (int i = 10; i <= 20; ++i) {
    Pose pose = walk(0.5 * i);
    pose.position.x() += 0.25;
    EXPECT_TRUE(evaluator.add(estimateAt(0.5 * i, pose, told)));
  }
  const auto evaluation = evaluator.finish();
  ASSERT_TRUE(evaluation);
  EXPECT_TRUE(evaluation->is_laid);
  for (const PoseError& error : evaluation->errors) {
    EXPECT_NEAR(error.position_m.norm(), error.t_s < 5.0 ? 0.0 : 0.25, 1e-9) << error.t_s;
    EXPECT_LT(error.rotation_rad.norm(), 1e-9);
  }
}

TEST(Evaluation, LaysNothingThatWasTold) {
  const std::vector<StampedPose> reference{{Time{}, walk(0)}, {after(Time{}, 1), walk(1)}};
  Evaluator evaluator(reference);
  Pose pose = walk(0);
  pose.position.z() += 2.0;
  EXPECT_TRUE(evaluator.add(estimateAt(0, pose, {true, false, true})));
  EXPECT_FALSE(evaluator.add(estimateAt(2, pose, {})));
  EXPECT_NEAR(evaluator.finish()->position_rms_m, 2.0, 1e-12);  // pressure tells the height
}

}  // namespace
}  // namespace fathom
