// Every Jacobian of the filter against numeric differentiation, over random states, for every sensor and both
// sizes.
#include <gtest/gtest.h>

#include "support/observed.h"
#include "support/random_state.h"

namespace fathom {
namespace {

using test::randomPose;
using test::randomState;

constexpr int kStates = 50;
// Central differences with step h err by h² f'''/6 + eps |f|/h; with h = 1e-5 and values up to 1e5 (pressure)
// relative to slopes of 1e4 that is below 1e-6 relative.
constexpr double kStep = 1e-5;
constexpr double kTolerance = 2e-6;

/// d residual / d error, column by column.
template <int N, class Make>
Eigen::MatrixXd numericJacobian(const NavigationState<double>& x, const Make& make) {
  const auto M = make(x).residual.size();
  Eigen::MatrixXd J(M, N);
  for (int k = 0; k < N; ++k) {
    auto plus = x, minus = x;
    Eigen::Matrix<double, N, 1> delta = Eigen::Matrix<double, N, 1>::Zero();
    delta[k] = kStep;
    retract<N>(plus, delta);
    delta[k] = -kStep;
    retract<N>(minus, delta);
    J.col(k) = (make(plus).residual - make(minus).residual) / (2.0 * kStep);
  }
  return J;
}

template <int N, class Measurement>
Eigen::MatrixXd denseH(const Measurement& m) {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(m.residual.size(), N);
  if constexpr (requires { m.H; })
    for (int k = 0; k < m.columns.count; ++k) H.col(m.columns.list[static_cast<std::size_t>(k)]) = m.H.col(k);
  else
    for (int k = 0; k < m.columns.size; ++k) H(k, m.columns.list[static_cast<std::size_t>(k)]) = 1.0;
  return H;
}

/// residual = z - h(x), so H = -d residual / d error; columns that a measurement does not list must be zero.
template <int N, class Make>
void expectJacobian(const NavigationState<double>& x, const Make& make, const char* what) {
  const Eigen::MatrixXd H = denseH<N>(make(x));
  const Eigen::MatrixXd numeric = -numericJacobian<N>(x, make);
  const double scale = std::max(1.0, numeric.cwiseAbs().maxCoeff());
  EXPECT_LT((H - numeric).cwiseAbs().maxCoeff(), kTolerance * scale) << what << "\n"
                                                                     << H << "\n\n"
                                                                     << numeric;
}

/// A calibration with every effect on: the Jacobian must hold with them, too. (With none, measurements list
/// fewer columns.)
EffectParameters<double> someCalibration(Random& random) {
  EffectParameters<double> calibration;
  calibration.on.set();
  for (double& value : calibration.values) value = 0.02 * random.normal();
  return calibration;
}

template <class T>
class FilterJacobians : public testing::Test {};
using Sizes = testing::Types<std::integral_constant<int, kCoreSize>, std::integral_constant<int, kFullSize>>;
TYPED_TEST_SUITE(FilterJacobians, Sizes);

TYPED_TEST(FilterJacobians, EverySensor) {
  constexpr int N = TypeParam::value;
  Random random(1);
  for (int i = 0; i < kStates; ++i) {
    auto x = randomState(random);
    const EffectParameters<double> calibration = someCalibration(random);
    const MeasurementContext context{&test::fullVehicle(),
                                     i % 2 == 0 ? calibration : EffectParameters<double>()};
    // Every channel there is. A rotation is measured within a radian, where Log is smooth; a beam looks down,
    // from a level vehicle with some tilt.
    [&]<class... Channels>(std::tuple<Channels...>*) {
      const auto check = [&]<class C>() {
        auto at = x;
        Observation seen{
            Vector3d(random.normal3()).head(C::channel.component_count),
            Observation::Covariance::Identity(C::channel.component_count, C::channel.component_count),
            randomPose(random), x.motion.R_odom_robot};
        seen.about =
            x.motion.R_odom_robot * seen.T_robot_sensor.rotation * expSO3<double>(0.3 * random.normal3());
        if (C::channel.is_indirect) {
          at.motion.R_odom_robot = expSO3<double>(0.2 * random.normal3());
          seen.T_robot_sensor = DvlSheet{}.T_robot_beam(static_cast<std::size_t>(i % 4));
        }
        expectJacobian<N>(
            at, [&](const NavigationState<double>& s) { return test::measured<N, C>(s, seen, context); },
            std::string(C::channel.id).c_str());
      };
      (check.template operator()<Channels>(), ...);
    }(static_cast<InstrumentChannels*>(nullptr));
  }
}

TYPED_TEST(FilterJacobians, DirectMeasurementIsTheIdentityInItsOwnTangentSpace) {
  constexpr int N = TypeParam::value;
  Random random(2);
  for (int i = 0; i < kStates; ++i) {
    const auto x = randomState(random);
    auto z = randomState(random);
    z.motion.R_odom_robot = x.motion.R_odom_robot * expSO3<double>(0.5 * random.normal3());
    const auto make = [&](const NavigationState<double>& s) {
      return directMeasurement<N, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14>(
          s, z, Eigen::Matrix<double, 15, 15>::Identity());
    };
    const auto m = make(x);
    // -d residual/d error is the inverse left Jacobian for the orientation; premultiplied by the left
    // Jacobian, as the measurement's covariance is, it must be the identity. The same for the covariance J I
    // J^T.
    Eigen::MatrixXd J = Eigen::MatrixXd::Identity(15, 15);
    J.block<3, 3>(3, 3) = rightJacobianSO3<double>(-m.residual.template segment<3>(3));
    const Eigen::MatrixXd numeric = -J * numericJacobian<N>(x, make);
    EXPECT_LT((denseH<N>(m) - numeric).cwiseAbs().maxCoeff(), kTolerance);
    EXPECT_LT((m.R - J * J.transpose()).cwiseAbs().maxCoeff(), 1e-12);
    // J Log = Log: the residual is the same in both tangent spaces.
    EXPECT_LT((J * m.residual - m.residual).norm(), 1e-12);
  }
}

TYPED_TEST(FilterJacobians, Transition) {
  constexpr int N = TypeParam::value;
  using Filter = ErrorStateFilter<N>;
  Random random(3);
  ProcessNoise noise;
  noise.bias_time_constant_s = 3.0;
  for (int i = 0; i < kStates; ++i) {
    const auto x = randomState(random);
    const double dt = random.uniform(0.001, kMaximumStep_s);
    auto moved = x;
    Filter::move(moved, dt, noise);
    Eigen::MatrixXd numeric(N, N);
    for (int k = 0; k < N; ++k) {
      typename Filter::Vector delta = Filter::Vector::Zero();
      auto plus = x, minus = x;
      delta[k] = kStep;
      retract<N>(plus, delta);
      delta[k] = -kStep;
      retract<N>(minus, delta);
      Filter::move(plus, dt, noise);
      Filter::move(minus, dt, noise);
      numeric.col(k) = (difference<N>(plus, moved) - difference<N>(minus, moved)) / (2.0 * kStep);
    }
    EXPECT_LT((Filter::transition(x, dt, noise) - numeric).cwiseAbs().maxCoeff(), kTolerance);
  }
}

}  // namespace
}  // namespace fathom
