// A panel whose pose is not known is estimated along with the robot: is the filter as sure of both as it is
// right, and does it do what a filter over all states written densely does?
#include <gtest/gtest.h>

#include "core/chi_square.h"
#include "core/linear_algebra.h"
#include "localization/measurements.h"
#include "support/landmark_runs.h"
#include "support/observed.h"
#include "support/random_state.h"

namespace fathom {
namespace {

using test::LandmarkRun;

constexpr int kPanelRuns = 30;
constexpr double kUnknown = std::numeric_limits<double>::infinity();

struct MeanNees {
  double robot = 0, smoothed_robot = 0;
  std::array<double, 2> panels{};
};

/// Over runs whose start is off by so many of its sigmas: of the last estimate, of one in the middle,
/// smoothed, and of both panels at the end.
MeanNees meanNees(const std::vector<PanelPrior>& priors, double start_error, bool smooth) {
  MeanNees mean;
  for (int k = 0; k < kPanelRuns; ++k) {
    LandmarkRun run;
    run.seed = 100 + static_cast<std::uint64_t>(k);
    run.options.smooth = smooth;
    run.options.gate.kind = Gate::Kind::none;
    run.panels.push_back({rotationFromYawPitchRoll(radians(30), 0, radians(90)), {5.0, 2.0, -4.5}});
    run.priors = priors;
    Random random = Random::stream(run.seed, 5);
    for (std::size_t i = 0; i < priors.size(); ++i) {
      run.priors[i].T_odom_panel = run.panels[i];
      if (std::isinf(priors[i].position_sigma_m)) continue;
      run.priors[i].T_odom_panel.position += priors[i].position_sigma_m * random.normal3();
      run.priors[i].T_odom_panel.rotation =
          run.panels[i].rotation * expSO3<double>(priors[i].angle_sigma_rad * random.normal3());
    }
    run.sees = [](std::size_t i, double t) { return i == 0 ? t < 12.0 || t > 20.0 : t > 8.0; };
    run.start_error = start_error;
    const auto outcome = run.run(30.0);
    const auto nees = [](const Vector6d& error, const Matrix6d& covariance) {
      return normalizedSquare(covariance, error) / kPanelRuns;
    };
    const Estimate& last =
        outcome.estimates[outcome.estimates.size() - 2];  // the truth's last pose is earlier
    mean.robot += nees(outcome.error(last), last.pose_covariance);
    if (smooth) {
      const Estimate& middle = outcome.smoothed[outcome.smoothed.size() / 3];
      mean.smoothed_robot += nees(outcome.error(middle), middle.pose_covariance);
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const UncertainPose& panel = outcome.summary.panels.at(i).T_odom_panel;
      mean.panels[i] += nees(poseDifference(run.panels[i], panel.pose), panel.covariance);
    }
  }
  return mean;
}

void expectConsistent(const std::vector<PanelPrior>& priors) {
  const MeanNees right = meanNees(priors, 1.0, true);
  // The start's sigmas are drawn, the motion is not the model's own: within the band of 99.9 % instead of 95
  // %.
  const double low = chiSquareQuantile(6 * kPanelRuns, 0.0005) / kPanelRuns,
               high = chiSquareQuantile(6 * kPanelRuns, 0.9995) / kPanelRuns;
  for (const double nees : {right.robot, right.smoothed_robot, right.panels[0], right.panels[1]}) {
    EXPECT_GT(nees, low);
    EXPECT_LT(nees, high);
  }
  EXPECT_GT(meanNees(priors, 2.0, false).robot, high);
}

TEST(PanelStates, RobotAndUnknownPanelsAreConsistent) {
  expectConsistent({{"A", {}, kUnknown, kUnknown}, {"B", {}, kUnknown, kUnknown}});
}

TEST(PanelStates, RobotAndUncertainPanelsAreConsistent) {
  expectConsistent({{"A", {}, 0.05, radians(2)}, {"B", {}, kUnknown, kUnknown}});
}

/// The same filter over N + 6 k states, dense, as a textbook has it; Jacobians by differences.
template <int N>
struct DenseFilter {
  NavigationState<double> x;
  std::vector<Pose> poses;
  Eigen::MatrixXd P;

  Eigen::Index size() const { return P.rows(); }
  void retractAll(const Eigen::VectorXd& delta) {
    retract<N>(x, delta.head<N>());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const auto row = N + 6 * static_cast<Eigen::Index>(i);
      poses[i].position += delta.segment<3>(row);
      poses[i].rotation = poses[i].rotation * expSO3<double>(delta.segment<3>(row + 3));
    }
  }
  DenseFilter moved(const Eigen::VectorXd& delta) const {
    DenseFilter other = *this;
    other.retractAll(delta);
    return other;
  }
  /// Of f(x), at zero, by each of `count` coordinates. Fourth order: off by some 1e-13 of x's unit, from
  /// rounding as from h^4/30 times the fifth derivative.
  template <class F>
  static Eigen::MatrixXd slopesOf(Eigen::Index count, const F& f) {
    constexpr double h = 1e-3;
    Eigen::MatrixXd J;
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto at = [&](double steps) -> Eigen::VectorXd {
        return f(Eigen::VectorXd(steps * h * Eigen::VectorXd::Unit(count, k)));
      };
      const Eigen::VectorXd slope = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
      if (k == 0) J.resize(slope.size(), count);
      J.col(k) = slope;
    }
    return J;
  }
  template <class F>
  Eigen::MatrixXd slopes(const F& f) const {
    return slopesOf(size(), [&](const Eigen::VectorXd& delta) { return f(moved(delta)); });
  }
  Pose robot() const { return {x.motion.R_odom_robot, x.motion.position_odom}; }

  void predict(double dt, const ProcessNoise& noise) {
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(size(), size()), Q = 0.0 * F;
    F.topLeftCorner(N, N) = ErrorStateFilter<N>::transition(x, dt, noise);
    Q.diagonal().head(N) = 0.5 * dt * ErrorStateFilter<N>::noiseDensity(noise);
    P = F * (P + Q) * F.transpose() + Q;
    ErrorStateFilter<N>::move(x, dt, noise);
  }
  double update(const Eigen::VectorXd& residual, const Eigen::MatrixXd& H, const Eigen::MatrixXd& R) {
    const Eigen::MatrixXd S_inverse = inverseOf(H * P * H.transpose() + R);
    const Eigen::MatrixXd K = P * H.transpose() * S_inverse;
    P = (P - K * H * P).eval();
    const Eigen::VectorXd delta = K * residual;
    retractAll(delta);
    Eigen::MatrixXd G = Eigen::MatrixXd::Identity(size(), size());
    G.block(3, 3, 3, 3) = rightJacobianSO3<double>(delta.segment<3>(3));
    for (Eigen::Index row = N + 3; row < size(); row += 6)
      G.block(row, row, 3, 3) = rightJacobianSO3<double>(delta.segment<3>(row));
    P = G * P * G.transpose();
    return residual.dot(S_inverse * residual);
  }
  void attach(const UncertainPose& sighting) {
    const Pose placed = robot() * sighting.pose;
    const Eigen::MatrixXd J = slopes([&](const DenseFilter& f) -> Eigen::VectorXd {
      return poseDifference(placed, f.robot() * sighting.pose);
    });
    const Matrix6d by_noise = slopesOf(6, [&](const Eigen::VectorXd& delta) -> Eigen::VectorXd {
      return poseDifference(placed, robot() * Pose{sighting.pose.rotation * expSO3<double>(delta.tail<3>()),
                                                   sighting.pose.position + delta.head<3>()});
    });
    const Eigen::Index n = size();
    Eigen::MatrixXd grown(n + 6, n + 6);
    grown.topLeftCorner(n, n) = P;
    grown.bottomLeftCorner(6, n) = J * P;
    grown.topRightCorner(n, 6) = (J * P).transpose();
    grown.bottomRightCorner(6, 6) =
        J * P * J.transpose() + by_noise * sighting.covariance * by_noise.transpose();
    P = grown;
    poses.push_back(placed);
  }
};

template <class Size>
class AttachedPosesTest : public testing::Test {};
using Sizes = testing::Types<std::integral_constant<int, kCoreSize>, std::integral_constant<int, kFullSize>>;
TYPED_TEST_SUITE(AttachedPosesTest, Sizes);

TYPED_TEST(AttachedPosesTest, EqualADenseFilterOverAllStates) {
  constexpr int N = TypeParam::value;
  Random random(11);
  ProcessNoise noise;
  noise.gyro_bias_sigma_rad_s.setConstant(1e-3);
  noise.accelerometer_bias_sigma_m_s2.setConstant(1e-2);
  ErrorStateFilter<N> filter;
  filter.x = test::randomState(random);
  filter.P = test::randomCovariance<N>(random, 0.01);
  DenseFilter<N> dense{filter.x, {}, filter.P};
  const auto sightingOf = [&](const Pose& pose) {
    UncertainPose sighting{Pose{filter.x.motion.R_odom_robot, filter.x.motion.position_odom}.inverse() *
                           pose};
    sighting.pose.position += 0.02 * random.normal3();
    sighting.pose.rotation = sighting.pose.rotation * expSO3<double>(0.02 * random.normal3());
    sighting.covariance = test::randomCovariance<6>(random, 1e-3);
    return sighting;
  };
  std::vector<Pose> panels(2);
  for (Pose& panel : panels) panel = {expSO3<double>(random.normal3()), 5.0 * random.normal3()};
  for (int k = 0; k < 60; ++k) {
    filter.predict(0.02, noise);
    dense.predict(0.02, noise);
    if (k == 5 || k == 20) {
      const UncertainPose sighting = sightingOf(panels[k == 20]);
      filter.attach(sighting);
      dense.attach(sighting);
    }
    const Vector3d velocity = filter.x.motion.velocity_robot + 0.05 * random.normal3();
    const auto m = test::measured<N, Dvl>(
        filter.x,
        Observation::vector(velocity, Vector3d::Constant(0.05), {Matrix3d::Identity(), {0.1, 0.2, 0.3}}),
        {&test::fullVehicle(), {}});
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3, dense.size());
    for (int i = 0; i < m.columns.count; ++i) H.col(m.columns.list[static_cast<std::size_t>(i)]) = m.H.col(i);
    const Eigen::VectorXd residual = m.residual;
    const Eigen::MatrixXd R = m.R;
    EXPECT_NEAR(filter.update(m).nis, dense.update(residual, H, R), 1e-6);
    if (k % 7 == 0)
      for (std::size_t i = 0; i < dense.poses.size(); ++i) {
        const UncertainPose sighting = sightingOf(panels[i]);
        const Pose seen = dense.robot().inverse() * dense.poses[i];
        const Eigen::MatrixXd J = dense.slopes([&](const DenseFilter<N>& f) -> Eigen::VectorXd {
          return poseDifference(seen, f.robot().inverse() * f.poses[i]);
        });
        const double expected = dense.update(poseDifference(seen, sighting.pose), J, sighting.covariance);
        EXPECT_NEAR(filter.updateSighting(static_cast<int>(i), sighting, 1e9).nis, expected,
                    1e-4 * (1 + expected));
      }
  }
  EXPECT_LT(difference<N>(filter.x, dense.x).norm(), 1e-6);
  EXPECT_LT((filter.wholeCovariance() - dense.P).norm(), 1e-6 * dense.P.norm());
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LT(poseDifference(filter.attached.T_odom[i], dense.poses[i]).norm(), 1e-6);
  EXPECT_EQ(filter.P, filter.P.transpose());
  EXPECT_GT(eigenOf(filter.wholeCovariance()).values.minCoeff(), 0.0);
}

// Acquired anew by an attached pose, the robot is as uncertain as pose and sighting together; with an exact
// one, as the sighting.
TYPED_TEST(AttachedPosesTest, ResetPoseTakesThePosesUncertainty) {
  constexpr int N = TypeParam::value;
  Random random(12);
  ErrorStateFilter<N> filter;
  filter.x = test::randomState(random);
  filter.P = test::randomCovariance<N>(random, 0.01);
  UncertainPose sighting{{expSO3<double>(random.normal3()), random.normal3()}, Matrix6d::Identity() * 1e-4};
  filter.attach(sighting);
  const UncertainPose pose = filter.attachedPose(0);
  sighting.pose.position += random.normal3();
  filter.resetPose(0, sighting);
  // Seen from there, the pose is exactly where the sighting says, and known as well as the sighting is.
  const auto [seen, J_robot, J_pose] =
      between({filter.x.motion.R_odom_robot, filter.x.motion.position_odom}, filter.attached.T_odom[0]);
  EXPECT_LT(poseDifference(sighting.pose, seen).norm(), 1e-9);
  const Matrix6d cross = filter.attached.cross.template leftCols<6>();
  const Matrix6d mixed = J_robot * cross.transpose() * J_pose.transpose();
  const Matrix6d covariance = J_robot * filter.P.template topLeftCorner<6, 6>() * J_robot.transpose() +
                              J_pose * pose.covariance * J_pose.transpose() + mixed + mixed.transpose();
  EXPECT_LT((covariance - sighting.covariance).norm(), 1e-9);
  EXPECT_GT(eigenOf(filter.wholeCovariance()).values.minCoeff(), -1e-12);
}

}  // namespace
}  // namespace fathom
