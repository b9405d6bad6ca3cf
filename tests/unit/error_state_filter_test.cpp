#include "localization/error_state_filter.h"

#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "localization/measurements.h"
#include "support/ill_conditioned.h"
#include "support/observed.h"
#include "support/random_state.h"
#include "support/textbook_filter.h"

namespace fathom {
namespace {

using test::randomCovariance;
using test::randomPose;
using test::randomState;
using test::TextbookFilter;

ProcessNoise someNoise() {
  ProcessNoise noise;
  noise.position.setConstant(1e-3);
  noise.orientation.setConstant(2e-3);
  noise.velocity.setConstant(3e-3);
  noise.gyro_bias_sigma_rad_s.setConstant(1e-3);
  noise.accelerometer_bias_sigma_m_s2.setConstant(1e-2);
  return noise;
}

std::vector<Instructions> instructionsHere() {
  std::vector<Instructions> all{Instructions::base};
  if (processorHas(Instructions::wide)) all.push_back(Instructions::wide);
  return all;
}

template <class T>
class FilterSizes : public testing::Test {};
using Sizes = testing::Types<std::integral_constant<int, kCoreSize>, std::integral_constant<int, kFullSize>>;
TYPED_TEST_SUITE(FilterSizes, Sizes);

// The block-sparse, stabilized filter against dense textbook algebra: only rounding may differ.
TYPED_TEST(FilterSizes, EqualsTheTextbook) {
  constexpr int N = TypeParam::value;
  Random random(4);
  const ProcessNoise noise = someNoise();
  for (int run = 0; run < 20; ++run) {
    ErrorStateFilter<N> ours;
    ours.kernels =
        &covarianceKernels<N>(instructionsHere()[static_cast<std::size_t>(run) % instructionsHere().size()]);
    TextbookFilter<N> textbook;
    ours.x = textbook.x = randomState(random);
    ours.P = randomCovariance<N>(random, 0.01);
    textbook.P = ours.P;
    const MeasurementContext context{&test::fullVehicle(), {}};
    for (int k = 0; k < 20; ++k) {
      const double dt = random.uniform(0.0, 0.2);
      ours.predict(dt, noise);
      textbook.predict(dt, noise);
      const Pose mount = randomPose(random);
      const auto accelerometer = test::measured<N, Accelerometer>(
          ours.x, Observation::vector(random.normal3(), Vector3d::Constant(0.3), mount), context);
      const double nis = ours.update(accelerometer).nis;
      EXPECT_NEAR(
          nis,
          textbook.update(accelerometer, {accelerometer.columns.list.begin(),
                                          accelerometer.columns.list.begin() + accelerometer.columns.count}),
          1e-8 * (1.0 + nis));
      auto z = ours.x;
      retract<N>(z, 0.1 * Eigen::Matrix<double, N, 1>::Ones());
      const auto pose = directMeasurement<N, 0, 1, 2, 3, 4, 5>(ours.x, z, randomCovariance<6>(random, 0.01));
      ours.update(pose);
      textbook.update(pose, {0, 1, 2, 3, 4, 5});
    }
    EXPECT_LT((difference<N>(ours.x, textbook.x)).norm(), 1e-9);
    EXPECT_LT((ours.P - textbook.P).norm(), 1e-9 * textbook.P.norm());
    EXPECT_EQ(ours.P, ours.P.transpose());
  }
}

// A very precise reading on a very uncertain state is where P - K H P loses definiteness.
TYPED_TEST(FilterSizes, StaysPositiveDefiniteUnderExtremeInformation) {
  constexpr int N = TypeParam::value;
  Random random(5);
  ErrorStateFilter<N> filter;
  filter.x = randomState(random);
  filter.P = randomCovariance<N>(random, 1e4);
  for (int k = 0; k < 200; ++k) {
    filter.predict(0.01, someNoise());
    const auto z = filter.x;
    filter.update(
        directMeasurement<N, 0, 1, 2, 3, 4, 5>(filter.x, z, 1e-8 * Eigen::Matrix<double, 6, 6>::Identity()));
    filter.update(directMeasurement<N, 6, 7, 8>(filter.x, z, 1e-8 * Matrix3d::Identity()));
    ASSERT_EQ(filter.P, filter.P.transpose());
    ASSERT_GT(eigenOf(filter.P).values.minCoeff(), 0.0) << "after update " << k;
  }
}

TYPED_TEST(FilterSizes, StaysPositiveDefiniteForLong) {
  for (const Instructions instructions : instructionsHere()) {
    test::IllConditionedRun<TypeParam::value> run(instructions);
    for (int k = 0; k < 20000; ++k) {
      run.step();
      if (k % 7 != 0) continue;
      ASSERT_TRUE(run.isSymmetric()) << "after step " << k;
      ASSERT_GT(run.leastEigenvalue(), 0.0) << "after step " << k;
    }
  }
}

// One filter on each set of instructions, which round differently: no more than that.
TYPED_TEST(FilterSizes, InstructionsDifferByRounding) {
  constexpr int N = TypeParam::value;
  if (!processorHas(Instructions::wide)) GTEST_SKIP() << "the processor has no AVX2";
  Random random(7);
  ErrorStateFilter<N> base, wide;
  base.kernels = &covarianceKernels<N>(Instructions::base);
  wide.kernels = &covarianceKernels<N>(Instructions::wide);
  base.x = wide.x = randomState(random);
  base.P = wide.P = randomCovariance<N>(random, 0.01);
  const MeasurementContext context{&test::fullVehicle(), {}};
  for (int k = 0; k < 200; ++k) {
    const auto seen = Observation::vector(random.normal3(), Vector3d::Constant(0.3), randomPose(random));
    for (auto* filter : {&base, &wide}) {
      filter->predict(0.02, someNoise());
      filter->update(test::measured<N, Gyro>(filter->x, seen, context));
    }
  }
  EXPECT_LT((difference<N>(base.x, wide.x)).norm(), 1e-11);
  EXPECT_LT((base.P - wide.P).norm(), 1e-11 * base.P.norm());
}

TYPED_TEST(FilterSizes, GatedReadingChangesNothing) {
  constexpr int N = TypeParam::value;
  Random random(6);
  ErrorStateFilter<N> filter;
  filter.x = randomState(random);
  filter.P = randomCovariance<N>(random, 0.01);
  const auto before = filter;
  auto z = filter.x;
  z.motion.position_odom.x() += 100.0;
  const auto m = directMeasurement<N, 0, 1, 2>(filter.x, z, Matrix3d::Identity());
  const Update rejected = filter.update(m, 16.3);
  EXPECT_GT(rejected.nis, 16.3);
  EXPECT_FALSE(rejected.fused);
  auto garbage = m;
  garbage.residual[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(filter.update(garbage).fused);
  for (const double dt :
       {-1e-9, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(filter.predict(dt, {}), std::invalid_argument) << dt;
  EXPECT_EQ(filter.P, before.P);
  EXPECT_EQ(filter.x.motion.position_odom, before.x.motion.position_odom);
}

// On a circle at constant speed dv_robot/dt is zero while the acceleration is omega x v: without that term in
// the motion model the velocity would turn out of the robot's axes. The step is second order: its error a
// step is about speed rate² dt³/6 = 4e-8 m, over 1257 steps below 1e-4 m.
TEST(Motion, CircleCloses) {
  NavigationState<double> x;
  const double speed = 1.0, rate = 0.5;
  x.motion.velocity_robot = {speed, 0, 0};
  x.motion.angular_velocity_robot = {0, 0, rate};
  x.motion.acceleration_robot = {0, speed * rate, 0};
  const int steps = 1257;  // 2 pi / 0.5 in 10 ms steps: 12.566 s
  const double dt = 2.0 * std::numbers::pi / rate / steps;
  for (int k = 0; k < steps; ++k) ErrorStateFilter<kCoreSize>::move(x, dt, {});
  EXPECT_LT(x.motion.position_odom.norm(), 1e-4);
  EXPECT_LT(angleBetween(x.motion.R_odom_robot, Matrix3d::Identity()), 1e-9);
  EXPECT_LT((x.motion.velocity_robot - Vector3d(speed, 0, 0)).norm(), 1e-4);
}

// Noise over one long step equals noise over many short ones (position variance of integrated white
// acceleration noise after T: q T^5/20, T = 1 s).
TEST(Motion, NoiseIntegralMatchesItsClosedForm) {
  ProcessNoise noise;
  noise.angular_velocity.setConstant(0.02);
  noise.acceleration.setConstant(0.3);
  ErrorStateFilter<kCoreSize> filter;
  filter.P.setZero();
  for (int k = 0; k < 1000; ++k) filter.predict(1e-3, noise);
  EXPECT_NEAR(filter.P(kAcceleration, kAcceleration), 0.3, 1e-9);
  EXPECT_NEAR(filter.P(kVelocity, kVelocity), 0.3 / 3.0, 1e-4);
  EXPECT_NEAR(filter.P(kPosition, kPosition), 0.3 / 20.0, 1e-4);
  EXPECT_NEAR(filter.P(kOrientation, kOrientation), 0.02 / 3.0, 1e-5);
}

}  // namespace
}  // namespace fathom
