// Is the filter as sure as it is right? 50 seeded runs for every sensor set: truth drawn from the filter's
// own motion model, readings from the sensors' forward model with the data sheet's noise. The mean normalized
// estimation error squared (NEES) of all states must lie in its chi-square band, and outside it when the
// assumed noise is wrong by 2.
#include <gtest/gtest.h>

#include "core/chi_square.h"
#include "core/linear_algebra.h"
#include "localization/measurements.h"
#include "support/observed.h"
#include "support/random_state.h"

namespace fathom {
namespace {

constexpr int kRuns = 50;
constexpr int kSteps = 400;  // 8 s at 50 Hz
constexpr double kDt = 0.02;

struct SensorSet {
  const char* name;
  bool gyro, accelerometer, attitude, dvl, altitude, depth, usbl, landmark;
};
std::ostream& operator<<(std::ostream& out, const SensorSet& set) { return out << set.name; }

struct Sigmas {
  double gyro = 0.002, accelerometer = 0.02, attitude = 0.01, dvl = 0.01, beam = 0.02, usbl = 0.3,
         landmark_m = 0.05, landmark_rad = 0.02;
  DepthSheet depth;
};

ProcessNoise consistentNoise() {
  ProcessNoise noise;
  noise.angular_velocity.setConstant(1e-3);
  noise.acceleration.setConstant(1e-2);
  noise.sea_floor = 1e-4;
  noise.gyro_bias_sigma_rad_s.setConstant(0.002);
  noise.accelerometer_bias_sigma_m_s2.setConstant(0.02);
  noise.bias_time_constant_s = 20.0;
  return noise;
}

template <int N>
Eigen::Matrix<double, N, 1> initialSigma() {
  Eigen::Matrix<double, kFullSize, 1> sigma;
  sigma << Vector3d::Constant(0.1), Vector3d::Constant(0.02), Vector3d::Constant(0.1),
      Vector3d::Constant(0.02), Vector3d::Constant(0.05), Vector3d::Constant(0.002), Vector3d::Constant(0.02),
      100.0, 0.3;
  return sigma.head<N>();
}

template <int N>
Eigen::Matrix<double, N, 1> draw(const Eigen::Matrix<double, N, 1>& sigma, Random& random) {
  Eigen::Matrix<double, N, 1> values;
  for (int i = 0; i < N; ++i) values[i] = sigma[i] * random.normal();
  return values;
}

/// One step of the stochastic motion model whose covariance is ErrorStateFilter's.
template <int N>
void moveRandomly(NavigationState<double>& truth, const ProcessNoise& noise, Random& random) {
  using Filter = ErrorStateFilter<N>;
  const typename Filter::Vector sigma = (0.5 * kDt * Filter::noiseDensity(noise)).cwiseSqrt();
  retract<N>(truth, draw<N>(sigma, random));
  Filter::move(truth, kDt, noise);
  retract<N>(truth, draw<N>(sigma, random));
}

/// Truth, readings of it (noise times `noise_factor`, which the filter does not know), filter. Returns the
/// mean NEES.
template <int N>
double meanNees(const SensorSet& use, std::uint64_t seed, double noise_factor) {
  Random random = Random::stream(seed, 77);
  const ProcessNoise noise = consistentNoise();
  const Sigmas sigma;
  const Pose ins{expSO3<double>(Vector3d(0.1, -0.2, 0.3)), {0.05, -0.02, 0.03}};
  const Pose dvl{expSO3<double>(Vector3d(0, 0, 0.8)), {-0.2, 0.05, -0.18}};
  const Pose other{Matrix3d::Identity(), {-0.1, 0.1, 0.3}};
  Vehicle vehicle = test::fullVehicle();
  vehicle.dvl->T_robot_dvl = dvl;
  vehicle.depth = sigma.depth;
  const MeasurementContext context{&vehicle, {}};

  NavigationState<double> truth;
  truth.motion.velocity_robot = {0.5, 0, 0};
  truth.motion.position_odom.z() = -4.0;
  truth.sea_floor_z_m = -8.0;
  ErrorStateFilter<N> filter;
  filter.x = truth;
  filter.P = initialSigma<N>().cwiseAbs2().asDiagonal();
  retract<N>(truth, draw<N>(initialSigma<N>(), random));

  const auto noise3 = [&](double s) -> Vector3d { return noise_factor * s * random.normal3(); };
  double sum = 0.0;
  int count = 0;
  for (int k = 1; k <= kSteps; ++k) {
    moveRandomly<N>(truth, noise, random);
    filter.predict(kDt, noise);
    const Inputs<double> in = test::inputs(truth.motion, {vehicle.gravityOdom(), truth.sea_floor_z_m},
                                           effectsOf(truth, context.calibration, 0, {}));
    const auto update = [&]<class C>(const Observation& seen) {
      filter.update(test::measured<N, C>(filter.x, seen, context));
    };
    if (use.gyro)
      update.template operator()<Gyro>(Observation::vector(
          Gyro::angularVelocity(in, ins) + noise3(sigma.gyro), Vector3d::Constant(sigma.gyro), ins));
    if (use.accelerometer)
      update.template operator()<Accelerometer>(
          Observation::vector(Accelerometer::specificForce(in, ins) + noise3(sigma.accelerometer),
                              Vector3d::Constant(sigma.accelerometer), ins));
    if (use.attitude && k % 5 == 0)
      update.template operator()<Attitude>(Observation::rotation(
          Attitude::orientation(in, ins) * expSO3<double>(noise3(sigma.attitude)), sigma.attitude, ins));
    if (use.dvl && k % 10 == 0)
      update.template operator()<Dvl>(Observation::vector(Dvl::velocity(in, dvl) + noise3(sigma.dvl),
                                                          Vector3d::Constant(sigma.dvl), dvl));
    if (use.altitude && k % 10 == 0)
      for (std::size_t beam = 0; beam < 4; ++beam) {
        const Pose T_robot_beam = vehicle.dvl->T_robot_beam(beam);
        const double range = DvlBeams::range(in, dvl, T_robot_beam);
        update.template operator()<DvlBeams>(Observation::scalar(
            range + noise_factor * sigma.beam * random.normal(), sigma.beam, T_robot_beam));
      }
    if (use.depth && k % 10 == 0)
      update.template operator()<Depth>(
          Observation::scalar(Depth::pressure(in, sigma.depth, other) +
                                  noise_factor * sigma.depth.pressure_sigma_pa * random.normal(),
                              sigma.depth.pressure_sigma_pa, other));
    if (use.usbl && k % 50 == 0)
      update.template operator()<Usbl>(Observation::vector(Usbl::position(in, other) + noise3(sigma.usbl),
                                                           Vector3d::Constant(sigma.usbl), other));
    if (use.landmark && k % 25 == 0) {
      auto z = truth;
      z.motion.position_odom += noise3(sigma.landmark_m);
      z.motion.R_odom_robot = z.motion.R_odom_robot * expSO3<double>(noise3(sigma.landmark_rad));
      Eigen::Matrix<double, 6, 1> variance;
      variance << Vector3d::Constant(sigma.landmark_m * sigma.landmark_m),
          Vector3d::Constant(sigma.landmark_rad * sigma.landmark_rad);
      filter.update(directMeasurement<N, 0, 1, 2, 3, 4, 5>(
          filter.x, z, Eigen::Matrix<double, 6, 6>(variance.asDiagonal())));
    }
    if (k % 100 == 0) {
      const auto error = difference<N>(truth, filter.x);
      sum += normalizedSquare(filter.P, error);
      ++count;
    }
  }
  return sum / count;
}

template <int N>
double meanOverRuns(const SensorSet& set, double noise_factor) {
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run)
    sum += meanNees<N>(set, static_cast<std::uint64_t>(run), noise_factor);
  return sum / kRuns;
}

class Nees : public testing::TestWithParam<SensorSet> {};

// Each run's value is a mean over four instants, which are correlated: the band for single instants is the
// wider one and is what a consistent filter must at least keep.
TEST_P(Nees, LiesInItsBandAndLeavesItWhenTheNoiseIsWrong) {
  const auto [low, high] = meanChiSquareBand(kFullSize, kRuns);
  const double nees = meanOverRuns<kFullSize>(GetParam(), 1.0);
  EXPECT_GT(nees, low);
  EXPECT_LT(nees, high);
  EXPECT_GT(meanOverRuns<kFullSize>(GetParam(), 2.0), high);
}

INSTANTIATE_TEST_SUITE_P(
    SensorSets, Nees,
    testing::Values(  //                   gyro  acc   att    dvl    alt    depth  usbl   landmark
        SensorSet{"Ins", true, true, false, false, false, false, false, false},
        SensorSet{"InsAttitude", true, true, true, false, false, false, false, false},
        SensorSet{"InsDvl", true, true, false, true, false, false, false, false},
        SensorSet{"InsDvlAltitude", true, true, false, true, true, false, false, false},
        SensorSet{"InsDvlDepth", true, true, false, true, false, true, false, false},
        SensorSet{"InsDvlUsbl", true, true, false, true, false, false, true, false},
        SensorSet{"InsDvlLandmark", true, true, false, true, false, false, false, true},
        SensorSet{"All", true, true, true, true, true, true, true, true}),
    [](const auto& set) { return std::string(set.param.name); });

// The paper's 15 states: truth has no bias then (the model draws none).
TEST(NeesCore, FifteenStates) {
  const SensorSet set{"InsDvl", true, true, false, true, false, true, false, true};
  const auto [low, high] = meanChiSquareBand(kCoreSize, kRuns);
  const double nees = meanOverRuns<kCoreSize>(set, 1.0);
  EXPECT_GT(nees, low);
  EXPECT_LT(nees, high);
  EXPECT_GT(meanOverRuns<kCoreSize>(set, 2.0), high);
}

}  // namespace
}  // namespace fathom
