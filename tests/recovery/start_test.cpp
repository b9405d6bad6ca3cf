// Where the path starts when nobody says so: fixes from the first second on, late ones, false ones, positions
// without a heading. Two seconds after the first right fix the estimate is within three of its sigmas.
#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "support/landmark_runs.h"

namespace fathom {
namespace {

using test::LandmarkRun;

/// Far from zero, and turned by 30 degrees.
const Pose kElsewhere{rotationFromYawPitchRoll(radians(30), 0, 0), {120.0, -45.0, 0.0}};

struct StartedByFixes : LandmarkRun {
  StartedByFixes() {
    start_is_given = false;
    T_odom_simulated = kElsewhere;
  }
};

/// Each coordinate of the pose, in its own sigmas.
void expectWithinThreeSigma(const LandmarkRun::Outcome& outcome, double from_s) {
  std::size_t beyond = 0, count = 0;
  for (const Estimate& e : outcome.estimates) {
    if (e.t_s < from_s) continue;
    const Vector6d sigma = e.pose_covariance.diagonal().cwiseSqrt();
    count += 6;
    beyond += static_cast<std::size_t>((outcome.error(e).cwiseAbs().array() > 3.0 * sigma.array()).count());
  }
  ASSERT_GT(count, 300u);
  // 0.27 % of normal errors are beyond; these are of one path, so that several are so together.
  EXPECT_LT(static_cast<double>(beyond), 0.02 * static_cast<double>(count)) << "from " << from_s << " s";
}

void expectOnTrack(const LandmarkRun::Outcome& outcome, double from_s, double to_s) {
  constexpr double kNear_m = 0.1;
  expectWithinThreeSigma(outcome, from_s);
  EXPECT_LT(outcome.worst(from_s, to_s), kNear_m);
  EXPECT_FALSE(outcome.summary.lost_since_s);
}

TEST(Start, IsWherePanelsAreSeenInTheFirstSeconds) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const auto form : {LandmarkOptions::Form::joint, LandmarkOptions::Form::mean}) {
      StartedByFixes run;
      run.seed = seed;
      run.options.landmarks.form = form;
      run.options.landmarks.position_sigma_m = 0.06;  // of a pose by a panel 5 m away, seen to 0.5 degrees
      const auto outcome = run.run(30.0);
      SCOPED_TRACE(outcome.summary.start_source);
      EXPECT_EQ(outcome.count("frame-moved") + outcome.count("reacquired"), 0u);
      expectWithinThreeSigma(outcome, 0.0);
      EXPECT_LT(outcome.worst(2.0, 30.0), 0.15);
    }
}

TEST(Start, IsMovedByAPanelThatIsSeenAfterAMinute) {
  StartedByFixes run;
  run.sees = [](std::size_t, double t_s) { return t_s > 60.0; };
  run.options.smooth = true;
  const auto outcome = run.run(90.0);
  EXPECT_EQ(outcome.count("frame-moved"), 1u);
  EXPECT_EQ(outcome.count("fix-rejected") + outcome.count("reacquired"), 0u);
  EXPECT_GT(outcome.worst(0.0, 60.0), 100.0);  // zero by definition
  expectOnTrack(outcome, 62.5, 90.0);
  // All of the path is in the frame that was found, within what a minute of dead reckoning is off by.
  for (const Estimate& e : outcome.smoothed) {
    const Vector6d sigma = e.pose_covariance.diagonal().cwiseSqrt();
    EXPECT_LT(outcome.error(e).head<3>().norm(), 0.5) << e.t_s;
    EXPECT_LT((outcome.error(e).cwiseAbs().array() / sigma.array()).maxCoeff(), 5.0) << e.t_s;
  }
}

TEST(Start, OutlastsAFalseFirstSighting) {
  for (const double first_s : {0.0, 60.0}) {
    StartedByFixes run;
    run.sees = [first_s](std::size_t, double t_s) { return t_s > first_s; };
    bool is_first = true;
    run.fault = [&is_first](Sample& sample, double, Random&) {
      if (auto* seen = std::get_if<PanelSample>(&sample.reading); seen && std::exchange(is_first, false)) {
        Pose& pose = seen->panels.front().T_camera_panel.pose;
        pose.position.x() += 2.0;
        pose.rotation = pose.rotation * expSO3<double>({0.0, 0.6, 0.0});
      }
      return true;
    };
    const auto outcome = run.run(first_s + 30.0);
    SCOPED_TRACE(outcome.summary.start_source);
    expectOnTrack(outcome, first_s + 2.8, first_s + 30.0);  // the second sighting comes half a second later
  }
}

/// The sighting turned and shifted, to somewhere else each time.
void spoil(PanelSample& seen, int time) {
  Pose& pose = seen.panels.front().T_camera_panel.pose;
  pose.position.x() += time % 2 == 0 ? 2.0 : -1.0 - time;
  pose.rotation = pose.rotation * expSO3<double>({0.0, 0.6 - 0.3 * time, 0.0});
}

// Which of the first sightings is right nothing tells: it is said to be lost until later ones agree.
TEST(Start, IsLostWhileSightingsContradictEachOther) {
  for (const int false_ones : {4, 12}) {  // more of them than it waits for
    StartedByFixes run;
    run.options.smooth = true;
    int sightings = 0;
    run.fault = [&](Sample& sample, double, Random&) {
      auto* seen = std::get_if<PanelSample>(&sample.reading);
      if (seen && sightings++ < false_ones) spoil(*seen, sightings);
      return true;
    };
    const auto outcome = run.run(30.0);
    SCOPED_TRACE(outcome.summary.start_source);
    const double last_s = 0.5 * false_ones;
    for (const Estimate& e : outcome.estimates)
      if (e.t_s < last_s) EXPECT_TRUE(e.lost || outcome.error(e).head<3>().norm() < 0.3) << e.t_s;
    expectOnTrack(outcome, last_s + 2.5, 30.0);
    // The path before comes along.
    for (const Estimate& e : outcome.smoothed) EXPECT_LT(outcome.error(e).head<3>().norm(), 0.2) << e.t_s;
  }
}

// The path before it comes along, first where the false one puts it, then where it was.
TEST(Start, AFalseFirstSightingIsTakenBackFromTheWholePath) {
  StartedByFixes run;
  run.options.smooth = true;
  run.sees = [](std::size_t, double t_s) { return t_s > 60.0; };
  bool is_first = true;
  run.fault = [&is_first](Sample& sample, double, Random&) {
    if (auto* seen = std::get_if<PanelSample>(&sample.reading); seen && std::exchange(is_first, false))
      spoil(*seen, 0);
    return true;
  };
  const auto outcome = run.run(90.0);
  EXPECT_EQ(outcome.count("lost"), 1u);
  // A minute of dead reckoning, as where no sighting is false.
  for (const Estimate& e : outcome.smoothed) EXPECT_LT(outcome.error(e).head<3>().norm(), 0.5) << e.t_s;
}

// (With seed 2 the depth is off by 3.5 sigma all along, also where no fix is false: its pressure offset is
// drawn so.)
TEST(Start, OutlastsAFalseFirstUsblFix) {
  for (std::uint64_t seed = 6; seed <= 15; ++seed) {
    StartedByFixes run;
    run.seed = seed;
    run.T_odom_simulated.rotation.setIdentity();
    run.simulation.vehicle.usbl.emplace().rate_hz = 0.5;
    run.simulation.vehicle.ins->attitude_sigma = radians(0.5);
    run.options.fuse = {kChannel<Gyro>, kChannel<Accelerometer>, kChannel<Attitude>,
                        kChannel<Dvl>,  kChannel<Depth>,         kChannel<Usbl>};
    run.sees = [](std::size_t, double) { return false; };
    bool is_first = true;
    run.fault = [&is_first](Sample& sample, double, Random&) {
      if (auto* fix = std::get_if<PoseSample>(&sample.reading);
          fix && sample.label == labels::kUsbl && std::exchange(is_first, false))
        fix->T_odom_robot.mean.position += Vector3d(12.0, -5.0, 1.0);
      return true;
    };
    const auto outcome = run.run(60.0);
    SCOPED_TRACE(outcome.summary.start_source);
    expectWithinThreeSigma(outcome, 4.0);
    EXPECT_LT(outcome.worst(4.0, 60.0), 1.5);  // sigma 0.5 m in each axis
    EXPECT_FALSE(outcome.summary.lost_since_s);
  }
}

TEST(Start, IsMovedByUsblThatComesLate) {
  for (const bool turned : {false, true}) {
    StartedByFixes run;
    if (!turned) run.T_odom_simulated.rotation.setIdentity();
    run.simulation.vehicle.usbl.emplace().rate_hz = 1.0;
    run.options.fuse.push_back(kChannel<Usbl>);
    run.sees = [](std::size_t, double) { return false; };
    run.fault = [](Sample& sample, double t_s, Random&) {
      return sample.label != labels::kUsbl || t_s > 60.0;
    };
    const auto outcome = run.run(180.0);
    // In which way the robot heads in USBL's frame shows when it has come some metres.
    EXPECT_EQ(outcome.count("lost"), 1u);
    EXPECT_EQ(outcome.count("found"), 1u);
    ASSERT_NE(outcome.first("found"), nullptr);
    EXPECT_LT(outcome.first("found")->t_s, 90.0);
    expectWithinThreeSigma(outcome, outcome.first("found")->t_s);
    EXPECT_LT(outcome.worst(63.0, 180.0), 2.5);  // sigma 0.5 m in each axis
    EXPECT_FALSE(outcome.summary.lost_since_s);
  }
}

TEST(Start, IsADefinitionWhereNothingTells) {
  StartedByFixes run;
  run.sees = [](std::size_t, double) { return false; };
  const auto outcome = run.run(20.0);
  EXPECT_NE(outcome.summary.start_source.find("zero by definition"), std::string::npos);
  const Estimate& first = outcome.estimates.front();
  EXPECT_LT(first.state.motion.position_odom.head<2>().norm(), 0.05);
  EXPECT_FALSE(outcome.summary.lost_since_s);
}

}  // namespace
}  // namespace fathom
