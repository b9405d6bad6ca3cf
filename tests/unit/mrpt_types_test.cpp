#include "recording/mrpt_types.h"

#include <gtest/gtest.h>

#include "support/recordings.h"

namespace fathom::test {
namespace {

TEST(MrptTypes, ClockIsMrpts) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double seconds = random.uniform(0, 4e9);
    const Time time = fromUnixSeconds(seconds);
    EXPECT_EQ(toMrpt(time), mrpt::Clock::fromDouble(seconds));
    EXPECT_EQ(fromMrpt(toMrpt(time)), time);
    EXPECT_EQ(toUnixSeconds(time), mrpt::Clock::toDouble(toMrpt(time)));
  }
  EXPECT_EQ(toUnixSeconds(Time{}), mrpt::Clock::toDouble({}));
}

TEST(MrptTypes, ThereAndBackIsExact) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const RecordedCamera camera = randomCamera(random);
    EXPECT_TRUE(fromMrpt(toMrpt(camera)) == camera);
    const YawPitchRollPose pose{randomPose(random), Matrix6d::Random()};
    const YawPitchRollPose back = fromMrpt(toMrpt(pose));
    EXPECT_EQ(back.mean.position, pose.mean.position);
    EXPECT_EQ(back.mean.rotation, pose.mean.rotation);
    EXPECT_EQ(back.covariance, pose.covariance);
  }
}

}  // namespace
}  // namespace fathom::test
