#include "localization/noise_adaptation.h"

#include <gtest/gtest.h>

#include "core/random.h"

// The truth is the noise that the readings are drawn with.
namespace fathom {
namespace {

/// A filter of three random walks, each read with noise, that follows what it is told of both.
class Level {
 public:
  Level(double assumed_R, double assumed_q) : R_(assumed_R), q_(assumed_q) {}

  void read(const Vector3d& reading, LevelVariances& variances) {
    P_ += q_ * variances.driveTimes();
    const double R = R_ * variances.measurementTimes(), S = P_ + R;
    const Vector3d residual = reading - x_;
    Shown shown{3, residual.squaredNorm() / S, R / S};
    for (int k = 0; k < 3; ++k) shown.residual[static_cast<std::size_t>(k)] = residual[k] / std::sqrt(S);
    nis_ += shown.nis;
    ++count_;
    x_ += P_ / S * residual;
    P_ *= R / S;
    variances.add(shown);
  }
  double takeNisMean() { return std::exchange(nis_, 0.0) / std::exchange(count_, 0); }

 private:
  double R_, q_, P_ = 1.0, nis_ = 0.0;
  Vector3d x_ = Vector3d::Zero();
  int count_ = 0;
};

struct Case {
  double R, q;  ///< true, of what is assumed
};

class LevelVariancesTest : public testing::TestWithParam<Case> {};

// Each judgement is of 300 numbers and counts a tenth: R scatters by sqrt(2/300 0.1/1.9) and what the gain
// adds, some 5 %; the drive by twice as much.
TEST_P(LevelVariancesTest, FollowBothNoises) {
  const double R = GetParam().R, q = GetParam().q;
  Random random(5);
  LevelVariances variances(1e-4);
  Level level(1.0, 0.1);
  Vector3d truth = Vector3d::Zero();
  const auto read = [&](int count) {
    for (int k = 0; k < count; ++k) {
      truth += std::sqrt(0.1 * q) * random.normal3();
      level.read(truth + std::sqrt(R) * random.normal3(), variances);
    }
  };
  read(10'000);
  level.takeNisMean();
  double R_found = 0.0, q_found = 0.0;
  constexpr int kParts = 20;
  for (int part = 0; part < kParts; ++part) {
    read(500);
    R_found += variances.measurementTimes() / kParts;
    q_found += variances.driveTimes() / kParts;
  }
  EXPECT_NEAR(R_found / R, 1.0, 0.1);
  EXPECT_NEAR(q_found / q, 1.0, 0.2);
  EXPECT_NEAR(level.takeNisMean() / 3.0, 1.0, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Of, LevelVariancesTest,
                         testing::Values(Case{1.0, 1.0}, Case{4.0, 1.0}, Case{1.0, 30.0}, Case{1.0, 0.03},
                                         Case{4.0, 0.1}, Case{3.0, 20.0}));

TEST(LevelVariances, ASigmaIsLoweredByLittle) {
  Random random(6);
  LevelVariances variances(1e-4);
  Level level(1.0, 0.1);
  for (int k = 0; k < 20'000; ++k) level.read(0.1 * random.normal3(), variances);
  EXPECT_NEAR(std::sqrt(variances.measurementTimes()), 0.84, 0.01);
}

// A vehicle that stood still for long, and whose drive is thought to be little, pushes.
TEST(LevelVariances, AnOnsetIsFollowedAtOnce) {
  Random random(7);
  LevelVariances variances(1e-4);
  Level level(1e-4, 1e-3);
  for (int k = 0; k < 20'000; ++k) level.read(0.01 * random.normal3(), variances);
  const double before = variances.driveTimes();
  EXPECT_LT(before, 0.01);
  for (int k = 1; k <= 50; ++k) level.read(Vector3d::Constant(0.05 * k) + 0.01 * random.normal3(), variances);
  EXPECT_GT(variances.driveTimes(), 100.0 * before);
}

TEST(MeasurementVariance, FollowsTheNoise) {
  Random random(8);
  for (const double truth : {1.0, 2.0, 6.0}) {
    MeasurementVariance variance;
    double found = 0.0;
    constexpr int kReadings = 4000;
    for (int k = 0; k < 2 * kReadings; ++k) {
      // Half of what a reading differs by is the prediction's.
      const double S = 1.0 + variance.times();
      const Vector3d residual = std::sqrt(1.0 + truth) * random.normal3();
      variance.add({3, residual.squaredNorm() / S, variance.times() / S, {}});
      if (k >= kReadings) found += variance.times() / kReadings;
    }
    EXPECT_NEAR(found / truth, 1.0, 0.1) << truth;
  }
}

// Nothing is told of a noise that is nothing beside the prediction's.
TEST(MeasurementVariance, StaysWhereNothingTellsIt) {
  MeasurementVariance variance;
  for (int k = 0; k < 1000; ++k) variance.add({3, 6.0, 1e-3, {}});
  EXPECT_NEAR(variance.times(), 1.0, 0.1);
}

// A compass that is off is no noisy compass: its sigma stays, and it contradicts.
TEST(NoiseAdaptation, WhatIsToOneSideIsNoNoise) {
  Random random(9);
  for (const double offset : {0.0, 3.0}) {
    NoiseAdaptation noise(true);
    int contradictions = 0;
    constexpr int kReadings = 400;
    for (int k = 0; k < kReadings; ++k) {
      const double times = noise.varianceTimes(kChannel<Compass>);
      const double residual = (random.normal() + offset) / std::sqrt(0.5 + 0.5 * times);
      const Shown shown{1, residual * residual, 0.5, {residual}};
      noise.add(kChannel<Compass>, shown);
      if (noise.contradicts(kChannel<Compass>, shown, shown.nis)) ++contradictions;
    }
    // It is taken for noise until the mean is known. Without that it goes to the bound, 9.
    EXPECT_LT(noise.varianceTimes(kChannel<Compass>), 4.0) << offset;
    if (offset == 0.0)
      EXPECT_EQ(contradictions, 0);
    else
      EXPECT_GT(contradictions, 0.9 * kReadings);
  }
}

// What a gyro without a bias state is off by is in its noise.
TEST(NoiseAdaptation, WithoutBiasStatesNothingIsLowered) {
  for (const bool has_bias_states : {false, true}) {
    Random random(10);
    NoiseAdaptation noise(has_bias_states);
    for (int k = 0; k < 5000; ++k) {
      const Vector3d residual = 0.2 * random.normal3();
      noise.add(kChannel<Gyro>, {3, residual.squaredNorm(), 0.5, {residual.x(), residual.y(), residual.z()}});
    }
    EXPECT_EQ(noise.varianceTimes(kChannel<Gyro>) < 1.0, has_bias_states);
    EXPECT_EQ(noise.drive().turning_times < 1.0, has_bias_states);
  }
}

TEST(NoiseAdaptation, ForgetsWhatIsNoNumber) {
  NoiseAdaptation noise(true);
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const Channel channel : {kChannel<Gyro>, kChannel<Dvl>}) {
    for (int k = 0; k < 500; ++k) noise.add(channel, {3, none, 0.5, {none, none, none}});
    EXPECT_EQ(noise.varianceTimes(channel), 1.0);
  }
  EXPECT_EQ(noise.drive().turning_times, 1.0);
}

/// A filter that was told of a bias by readings of it, with a prior of this sigma.
ErrorStateFilter<kFullSize> told(double prior, const Vector3d& bias, double reading_sigma) {
  ErrorStateFilter<kFullSize> filter;
  const double V = reading_sigma * reading_sigma, p = prior * prior;
  filter.P.diagonal().segment<3>(kAccelerometerBias).setConstant(1e-4);
  filter.P.diagonal().segment<3>(kGyroBias).setConstant(p * V / (p + V));
  filter.x.gyro_bias_rad_s = bias * p / (p + V);
  return filter;
}

TEST(BiasSigmas, GrowToABiasThatNobodyToldOf) {
  const Vector3d bias(1e-2, -2e-2, 0.0);
  // Read worse than the prior has it, so that the posterior is a part of it; and much better.
  for (const double reading_sigma : {3e-4, 1e-5}) {
    auto filter = told(1e-4, bias, reading_sigma);
    BiasSigmas sigmas{1e-4, 1e-2};
    EXPECT_EQ(sigmas.widen(filter), (std::vector<int>{kGyroBias, kGyroBias + 1, kGyroBias + 2}));
    EXPECT_NEAR(sigmas.gyro_rad_s, std::sqrt(5e-4 / 3.0), 1e-4);
    const auto truth = told(sigmas.gyro_rad_s, bias, reading_sigma);
    EXPECT_NEAR((filter.x.gyro_bias_rad_s - truth.x.gyro_bias_rad_s).norm(), 0.0, 1e-9)
        << "as if so from the start";
    EXPECT_NEAR(filter.P(kGyroBias, kGyroBias) / truth.P(kGyroBias, kGyroBias), 1.0, 1e-6);
    EXPECT_TRUE(sigmas.widen(filter).empty());
  }
}

TEST(BiasSigmas, AreLeftWhereABiasIsOrdinary) {
  for (const double reading_sigma : {1e-3, 1e-4, 1e-5}) {
    auto filter = told(1e-4, Vector3d(3e-4, 0.0, -3e-4), reading_sigma);
    BiasSigmas sigmas{1e-4, 1e-2};
    EXPECT_TRUE(sigmas.widen(filter).empty());
  }
}

TEST(BiasSigmas, AreNoLargerThanVehiclesHave) {
  auto filter = told(1e-4, Vector3d(3.0, 0.0, 0.0), 1e-4);
  BiasSigmas sigmas{1e-4, 1e-2};
  EXPECT_FALSE(sigmas.widen(filter).empty());
  EXPECT_DOUBLE_EQ(sigmas.gyro_rad_s, radians(1.0));
}

// What is correlated with the bias is moved along: a batch solution with the wider prior from the start.
TEST(ErrorStateFilter, APriorIsWidenedForAllStates) {
  ErrorStateFilter<kFullSize> narrow;
  narrow.P.setZero();
  narrow.P.diagonal().setOnes();
  narrow.P(kGyroBias, kGyroBias) = 1e-4;
  ErrorStateFilter<kFullSize> wide = narrow;
  wide.P(kGyroBias, kGyroBias) = 1e-2;
  const auto read = [](ErrorStateFilter<kFullSize>& filter) {  // of the sum of a bias and a velocity
    ErrorStateFilter<kFullSize>::Measurement<1> m;
    m.columns = {};
    m.columns.count = 2;
    m.columns.list[0] = kVelocity;
    m.columns.list[1] = kGyroBias;
    m.H.setZero();
    m.H(0, 0) = m.H(0, 1) = 1.0;
    m.R(0, 0) = 1e-3;
    m.residual[0] = 0.5 - filter.x.motion.velocity_robot.x() - filter.x.gyro_bias_rad_s.x();
    filter.update(m);
  };
  for (auto* filter : {&narrow, &wide}) read(*filter);
  narrow.widenPrior(kGyroBias, narrow.x.gyro_bias_rad_s.x(), 1e-2, 1e-1);
  EXPECT_NEAR(narrow.x.motion.velocity_robot.x(), wide.x.motion.velocity_robot.x(), 1e-9);
  EXPECT_NEAR(narrow.x.gyro_bias_rad_s.x(), wide.x.gyro_bias_rad_s.x(), 1e-9);
  EXPECT_LT((Eigen::MatrixXd(narrow.P) - Eigen::MatrixXd(wide.P)).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace fathom
