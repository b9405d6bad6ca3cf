// What the filter makes of landmarks that contradict it: false fixes, a wrong start, long times without any,
// a panel that was pushed, sensors that fail. In each case the right conclusion has to be drawn and named,
// and none where nothing is wrong.
#include <gtest/gtest.h>

#include <numbers>

#include "core/linear_algebra.h"
#include "support/landmark_runs.h"

namespace fathom {
namespace {

using test::LandmarkRun;

/// Where the estimate is off by half a metre it has to say that it is lost.
void expectNoSilentDivergence(const LandmarkRun::Outcome& outcome, double from_s, const std::string& fault) {
  for (const Estimate& e : outcome.estimates)
    if (e.t_s > from_s && !e.lost) {
      ASSERT_LT(outcome.error(e).head<3>().norm(), 0.5) << fault << ", at " << e.t_s << " s";
    }
}

std::string faultOf(double size, bool bias_states) {
  return std::to_string(size) + (bias_states ? ", 23 states" : ", 15 states");
}

/// Fixes are good to 1 cm and 0.5 degrees twice a second: the filter stays within this, m.
constexpr double kOnTrack_m = 0.1;

void turnAndShift(UncertainPose& seen, Random& random) {
  seen.pose.position += 1.0 * random.normal3();
  seen.pose.rotation = seen.pose.rotation * expSO3<double>(0.5 * random.normal3());
}

TEST(LandmarkHypotheses, NothingIsReportedWhereNothingIsWrong) {
  std::size_t gated = 0, fixes = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    LandmarkRun run;
    run.seed = seed;
    run.sees = [](std::size_t, double t) { return std::fmod(t, 20.0) < 12.0; };
    const auto outcome = run.run(60.0);
    for (const char* kind : {"reacquired", "panel-moved", "panel-prior", "panel-restarted", "lost"})
      EXPECT_EQ(outcome.count(kind), 0u) << kind << ", seed " << seed;
    EXPECT_EQ(outcome.summary.panels.at(0).state, PanelResult::State::known);
    EXPECT_LT(outcome.worst(20.0, 60.0), kOnTrack_m) << "seed " << seed;
    gated += outcome.count("fix-rejected");
    fixes += outcome.summary.channels.at(kChannel<Landmark>).fused;
  }
  // One in 10 000 good fixes is rejected; of some 2000 more than three by chance once in 10 000 such tests.
  EXPECT_GT(fixes, 2000u);
  EXPECT_LE(gated, 3u);
}

TEST(LandmarkHypotheses, SingleFalseFixesAreRejected) {
  LandmarkRun run;
  run.fault = [](Sample& sample, double t_s, Random& random) {
    if (auto* panels = std::get_if<PanelSample>(&sample.reading); panels && std::fmod(t_s, 10.0) < 0.5)
      turnAndShift(panels->panels.front().T_camera_panel, random);
    return true;
  };
  const auto outcome = run.run(60.0);
  EXPECT_GE(outcome.count("fix-rejected"), 5u);
  EXPECT_EQ(outcome.count("reacquired") + outcome.count("panel-moved") + outcome.count("lost"), 0u);
  EXPECT_LT(outcome.worst(5.0, 60.0), kOnTrack_m);
}

TEST(LandmarkHypotheses, BurstOfFalseFixesIsRejectedAsLongAsItLasts) {
  LandmarkRun run;
  run.fault = [](Sample& sample, double t_s, Random& random) {
    if (auto* panels = std::get_if<PanelSample>(&sample.reading); panels && t_s > 30.0 && t_s < 35.0)
      turnAndShift(panels->panels.front().T_camera_panel, random);
    return true;
  };
  const auto outcome = run.run(60.0);
  EXPECT_EQ(outcome.count("fix-rejected"), 10u);
  EXPECT_EQ(outcome.count("reacquired") + outcome.count("panel-moved") + outcome.count("lost"), 0u);
  EXPECT_LT(outcome.worst(5.0, 60.0), kOnTrack_m);
}

TEST(LandmarkHypotheses, WrongStartIsPutRight) {
  for (const bool bias_states : {true, false}) {
    LandmarkRun run;
    run.options.bias_states = bias_states;
    run.wrong_start_m = 10.0;
    run.wrong_start_rad = radians(60);
    const auto outcome = run.run(40.0);
    EXPECT_EQ(outcome.count("reacquired"), 1u);
    EXPECT_EQ(outcome.count("panel-moved"), 0u);
    ASSERT_NE(outcome.first("reacquired"), nullptr);
    EXPECT_LT(outcome.first("reacquired")->t_s, 4.0);  // five fixes at 2 Hz
    EXPECT_GT(outcome.worst(0.0, 2.0), 9.0);
    EXPECT_LT(outcome.worst(6.0, 40.0), kOnTrack_m);
    EXPECT_FALSE(outcome.estimates.back().lost);
  }
}

// Landmarks alone, and none for 80 s: where the vehicle looks is anyone's guess then. The first fix sets the
// pose, and motion starts as that of a vehicle of which nothing is known; no later fix has to contradict it.
TEST(LandmarkHypotheses, TheFirstFixAfterLongDarknessSetsThePose) {
  for (const bool bias_states : {true, false}) {
    LandmarkRun run;
    run.options.bias_states = bias_states;
    run.options.fuse.clear();
    run.sees = [](std::size_t, double t) { return t < 30.0 || t > 110.0; };
    const auto outcome = run.run(140.0);
    ASSERT_NE(outcome.first("reacquired"), nullptr);
    EXPECT_NEAR(outcome.first("reacquired")->t_s, 110.25, 0.01);
    EXPECT_EQ(outcome.count("panel-moved") + outcome.count("fix-rejected"), 0u);
    EXPECT_GT(outcome.worst(100.0, 110.0), 1.0);
    EXPECT_LT(outcome.worst(110.3, 140.0), 0.3);  // between fixes, half a second of a velocity not yet known
    // As before the dark: landmarks alone, with what the vehicle does between two of them.
    EXPECT_LT(outcome.worst(115.0, 140.0), 1.5 * outcome.worst(5.0, 30.0));
    EXPECT_LT(outcome.worst(5.0, 30.0), 0.3);
  }
}

// Two minutes out of view with a compass error the filter knows nothing of: a gyro bias of 0.3 degrees a
// second.
TEST(LandmarkHypotheses, DriftWithoutLandmarksIsPutRight) {
  for (const bool bias_states : {true, false}) {
    LandmarkRun run;
    run.options.bias_states = bias_states;
    run.sees = [](std::size_t, double t) { return t < 30.0 || t > 150.0; };
    run.fault = [](Sample& sample, double t_s, Random&) {
      if (auto* ins = std::get_if<InsSample>(&sample.reading); ins && t_s > 35.0 && t_s < 140.0)
        ins->angular_velocity_ins->z() += radians(0.3);
      return true;
    };
    const auto outcome = run.run(180.0);
    EXPECT_EQ(outcome.count("reacquired"), 1u);
    EXPECT_EQ(outcome.count("panel-moved"), 0u);
    EXPECT_GT(outcome.worst(149.0, 150.0), 0.3);
    EXPECT_LT(outcome.worst(155.0, 180.0), kOnTrack_m);
    EXPECT_FALSE(outcome.estimates.back().lost);
  }
}

TEST(LandmarkHypotheses, PushedPanelIsNoticedMeasuredAndUsed) {
  const Pose push{rotationFromYawPitchRoll(radians(0), radians(8), 0), {0.15, 0.0, 0.0}};
  for (const bool bias_states : {true, false}) {
    LandmarkRun run;
    run.options.bias_states = bias_states;
    run.T_odom_panel = [&](std::size_t, double t) { return t < 40.0 ? run.panels[0] : run.panels[0] * push; };
    const auto outcome = run.run(80.0);
    EXPECT_EQ(outcome.count("panel-moved"), 1u);
    EXPECT_EQ(outcome.count("reacquired") + outcome.count("lost"), 0u);
    const PanelResult& panel = outcome.summary.panels.at(0);
    ASSERT_EQ(panel.moves.size(), 1u);
    EXPECT_NEAR(panel.moves[0].t_s, 40.25, 0.01);
    const auto& [offset, covariance] = panel.moves[0].T_before_after;
    const Vector6d error = poseDifference(push, offset);
    EXPECT_LT(normalizedSquare(covariance, error), 22.5);  // chi-square, 6 degrees of freedom: 99.9 %
    EXPECT_LT(std::sqrt(covariance.topLeftCorner<3, 3>().trace()), 0.05);
    EXPECT_EQ(panel.state, PanelResult::State::estimated);
    EXPECT_LT((panel.T_odom_panel.pose.position - (run.panels[0] * push).position).norm(), 0.03);
    EXPECT_LT(outcome.worst(5.0, 80.0), kOnTrack_m);
  }
}

TEST(LandmarkHypotheses, OfTwoPanelsTheOneThatWasPushedIsNamed) {
  LandmarkRun run;
  run.panels.push_back({rotationFromYawPitchRoll(radians(30), 0, radians(90)), {5.0, 2.0, -4.5}});
  run.T_odom_panel = [&](std::size_t i, double t) {
    return i == 1 && t > 40.0
               ? run.panels[1] * Pose{rotationFromYawPitchRoll(radians(5), 0, 0), {0.1, 0.05, 0.0}}
               : run.panels[i];
  };
  const auto outcome = run.run(80.0);
  EXPECT_EQ(outcome.count("panel-moved"), 1u);
  EXPECT_EQ(outcome.count("reacquired") + outcome.count("lost"), 0u);
  EXPECT_EQ(outcome.summary.panels.at(0).state, PanelResult::State::known);
  EXPECT_EQ(outcome.summary.panels.at(1).state, PanelResult::State::estimated);
  EXPECT_EQ(outcome.summary.panels.at(1).moves.size(), 1u);
  EXPECT_LT(outcome.worst(5.0, 80.0), kOnTrack_m);
}

// A robot that is carried away (or a DVL that lies once) moves all panels alike.
TEST(LandmarkHypotheses, AllPanelsAtOnceMeanTheFilter) {
  LandmarkRun run;
  run.panels.push_back({rotationFromYawPitchRoll(radians(30), 0, radians(90)), {5.0, 2.0, -4.5}});
  const Pose carried{rotationFromYawPitchRoll(radians(10), 0, 0), {0.5, 0.5, 0.0}};
  run.T_odom_panel = [&](std::size_t i, double t) {
    return t > 40.0 ? carried * run.panels[i] : run.panels[i];
  };
  const auto outcome = run.run(60.0);
  EXPECT_EQ(outcome.count("panel-moved"), 0u);
  EXPECT_GE(outcome.count("reacquired"), 1u);
}

// A gyro that begins to lie while landmarks are in view is not the panel's doing, at any size; and where the
// estimate goes wrong for good, it says so.
TEST(LandmarkHypotheses, FaultyOdometryIsNoMovedPanel) {
  for (const double bias_deg_s : {0.1, 0.5, 2.0, 10.0, 60.0})
    for (const bool bias_states : {true, false}) {
      LandmarkRun run;
      run.options.bias_states = bias_states;
      run.fault = [&](Sample& sample, double t_s, Random&) {
        if (auto* ins = std::get_if<InsSample>(&sample.reading); ins && t_s > 30.0)
          ins->angular_velocity_ins->z() += radians(bias_deg_s);
        return true;
      };
      const auto outcome = run.run(90.0);
      EXPECT_EQ(outcome.count("panel-moved"), 0u) << bias_deg_s;
      expectNoSilentDivergence(outcome, 45.0, faultOf(bias_deg_s, bias_states));
    }
}

TEST(LandmarkHypotheses, FaultyDvlIsNoMovedPanel) {
  for (const double bias_m_s : {0.02, 0.05, 0.1, 0.2, 0.5, 2.0})
    for (const bool bias_states : {true, false}) {
      LandmarkRun run;
      run.options.bias_states = bias_states;
      run.fault = [&](Sample& sample, double t_s, Random&) {
        if (auto* dvl = std::get_if<DvlSample>(&sample.reading); dvl && dvl->velocity_dvl && t_s > 30.0)
          dvl->velocity_dvl->x() += bias_m_s;
        return true;
      };
      const auto outcome = run.run(90.0);
      EXPECT_EQ(outcome.count("panel-moved"), 0u) << bias_m_s;
      expectNoSilentDivergence(outcome, 45.0, faultOf(bias_m_s, bias_states));
    }
}

TEST(LandmarkHypotheses, LostWithoutDvlAndLandmarksAndFoundAgain) {
  LandmarkRun run;
  run.options.lost.position_sigma_m = run.options.lost.angle_sigma_rad = 1e6;
  run.sees = [](std::size_t, double t) { return t < 30.0 || t > 210.0; };
  run.fault = [](Sample& sample, double t_s, Random&) {
    const bool dvl = sample.label == labels::kDvl || sample.label == labels::kDvlBeams;
    return !(dvl && t_s > 30.0 && t_s < 230.0);
  };
  const auto outcome = run.run(240.0);
  ASSERT_EQ(outcome.count("lost"), 1u);
  EXPECT_NEAR(outcome.first("lost")->t_s, 60.0, 2.0);  // blind_s after the last reading
  ASSERT_EQ(outcome.count("found"), 1u);
  EXPECT_LT(outcome.first("found")->t_s, 215.0);
  for (const Estimate& e : outcome.estimates) {
    if (e.t_s < 60.0 || e.t_s > 212.0) {
      EXPECT_FALSE(e.lost) << e.t_s;
    } else if (e.t_s > 61.0 && e.t_s < 210.0) {
      EXPECT_TRUE(e.lost) << e.t_s;
    }
  }
  EXPECT_FALSE(outcome.summary.lost_since_s);
  EXPECT_LT(outcome.worst(220.0, 240.0), kOnTrack_m);
}

TEST(LandmarkHypotheses, EndingLostIsInTheSummary) {
  LandmarkRun run;
  run.sees = [](std::size_t, double t) { return t < 30.0; };
  run.fault = [](Sample& sample, double t_s, Random&) {
    return !(t_s > 30.0 && (sample.label == labels::kDvl || sample.label == labels::kDvlBeams));
  };
  const auto outcome = run.run(90.0);
  ASSERT_TRUE(outcome.summary.lost_since_s);
  EXPECT_GT(*outcome.summary.lost_since_s, 30.0);
  EXPECT_LT(*outcome.summary.lost_since_s, 60.0);  // by its own sigma, before it has been blind for 30 s
  EXPECT_NE(outcome.summary.lost_reason.find("sigma"), std::string::npos) << outcome.summary.lost_reason;
}

// The prior says the panel is elsewhere by ten of its sigmas.
TEST(LandmarkHypotheses, PriorThatContradictsIsNamedAndLeftAside) {
  LandmarkRun run;
  Pose elsewhere = run.panels[0];
  elsewhere.position.x() += 5.0;
  run.priors = {{"P0", elsewhere, 0.5, radians(5)}};
  const auto outcome = run.run(40.0);
  EXPECT_EQ(outcome.count("panel-prior"), 1u);
  EXPECT_EQ(outcome.count("reacquired") + outcome.count("panel-moved"), 0u);
  EXPECT_LT((outcome.summary.panels.at(0).T_odom_panel.pose.position - run.panels[0].position).norm(), 0.5);
}

// The first sighting of an unknown panel is a false one.
TEST(LandmarkHypotheses, PanelThatWasFirstSeenWronglyStartsAnew) {
  LandmarkRun run;
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  run.priors = {{"P0", {}, kUnknown, kUnknown}};
  run.fault = [](Sample& sample, double t_s, Random&) {
    if (auto* panels = std::get_if<PanelSample>(&sample.reading); panels && t_s < 0.5)
      panels->panels.front().T_camera_panel.pose.position.x() += 2.0;
    return true;
  };
  const auto outcome = run.run(40.0);
  EXPECT_EQ(outcome.count("panel-restarted"), 1u);
  EXPECT_EQ(outcome.count("reacquired"), 0u);
  EXPECT_LT((outcome.summary.panels.at(0).T_odom_panel.pose.position - run.panels[0].position).norm(), 0.5);
}

// The mean over markers is a robot's pose with a covariance from the options; of a single panel it is a
// sighting all the same.
TEST(LandmarkHypotheses, MeansOverMarkersAreJudgedAlike) {
  const auto meanRun = [](LandmarkRun& run) {
    run.options.landmarks.form = LandmarkOptions::Form::mean;
    run.options.landmarks.position_sigma_m = 0.03;  // 1 cm and 0.5 degrees seen from some 4 m
    run.options.landmarks.angle_sigma_rad = radians(0.5);
  };
  LandmarkRun nominal, start, pushed;
  for (LandmarkRun* run : {&nominal, &start, &pushed}) meanRun(*run);
  start.wrong_start_m = 10.0;
  start.wrong_start_rad = radians(60);
  const Pose push{rotationFromYawPitchRoll(0, radians(8), 0), {0.15, 0.0, 0.0}};
  pushed.fault = [&](Sample& sample, double t_s, Random&) {  // as the map has it still where it was
    if (auto* pose = std::get_if<PoseSample>(&sample.reading);
        pose && sample.label == labels::kMarkers && t_s > 30.0) {
      const Pose T_panel_robot = pushed.panels[0].inverse() * pose->T_odom_robot.mean;
      pose->T_odom_robot.mean = (pushed.panels[0] * push.inverse() * T_panel_robot);
    }
    return true;
  };
  const auto fine = nominal.run(60.0), put_right = start.run(60.0), moved = pushed.run(60.0);
  EXPECT_EQ(fine.count("reacquired") + fine.count("panel-moved") + fine.count("lost"), 0u);
  EXPECT_LT(fine.worst(5.0, 60.0), kOnTrack_m);
  EXPECT_EQ(put_right.count("reacquired"), 1u);
  EXPECT_LT(put_right.worst(10.0, 60.0), kOnTrack_m);
  EXPECT_EQ(moved.count("panel-moved"), 1u);
  EXPECT_EQ(moved.count("reacquired") + moved.count("lost"), 0u);
  EXPECT_LT(moved.worst(5.0, 60.0), 2 * kOnTrack_m);
  ASSERT_EQ(moved.summary.panels.at(0).moves.size(), 1u);
  const UncertainPose& offset = moved.summary.panels[0].moves[0].T_before_after;
  EXPECT_LT(poseDifference(push, offset.pose).head<3>().norm(), 0.1);
}

// Images take their time: sightings half a second late are fused at their own time, with all that they start.
TEST(LandmarkHypotheses, LateSightingsChangeNothing) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  const Pose push{rotationFromYawPitchRoll(0, radians(8), 0), {0.15, 0.0, 0.0}};
  LandmarkRun in_order, late;
  for (LandmarkRun* run : {&in_order, &late}) {
    run->priors = {{"P0", {}, kUnknown, kUnknown}};
    run->options.smooth = true;
    run->T_odom_panel = [run, &push](std::size_t, double t) {
      return t < 20.0 ? run->panels[0] : run->panels[0] * push;
    };
  }
  late.arrange = [](std::vector<Sample>& samples, const Time& zero) {
    const auto arrival = [&](const Sample& sample) {
      return secondsBetween(zero, sample.time) + (sample.label == labels::kPanel ? 0.51 : 0.0);
    };
    std::stable_sort(samples.begin(), samples.end(),
                     [&](const Sample& a, const Sample& b) { return arrival(a) < arrival(b); });
  };
  const auto expected = in_order.run(40.0), outcome = late.run(40.0);
  EXPECT_GT(outcome.summary.late_fused, 70u);
  ASSERT_EQ(outcome.estimates.size(), expected.estimates.size());
  EXPECT_EQ(outcome.events.size(), expected.events.size());
  EXPECT_EQ(expected.count("panel-moved"), 1u);
  for (std::size_t k = 0; k < expected.estimates.size(); ++k) {
    const auto& a = expected.smoothed[k].state.motion;
    const auto& b = outcome.smoothed[k].state.motion;
    ASSERT_LT((a.position_odom - b.position_odom).norm(), 1e-9) << k;
  }
}

// What is smoothed before a wrong start was noticed is not better for it, and what comes after not worse.
TEST(LandmarkHypotheses, SmootherDoesNotLookThroughAReset) {
  LandmarkRun run;
  run.options.smooth = true;
  run.wrong_start_m = 10.0;
  const auto outcome = run.run(40.0);
  const double at_s = outcome.first("reacquired")->t_s;
  for (const Estimate& e : outcome.smoothed) {
    ASSERT_TRUE(e.pose_covariance.allFinite());
    if (e.t_s > at_s + 0.5) {
      EXPECT_LT(outcome.error(e).head<3>().norm(), kOnTrack_m) << e.t_s;
    }
  }
}

// The paper's fixed gate and no gate at all are what they are: no hypotheses.
TEST(LandmarkHypotheses, OtherGatesArePlain) {
  for (const Gate::Kind kind : {Gate::Kind::none, Gate::Kind::fixed}) {
    LandmarkRun run;
    run.options.gate.kind = kind;
    run.wrong_start_m = 10.0;
    const auto outcome = run.run(30.0);
    EXPECT_EQ(outcome.count("reacquired") + outcome.count("fix-rejected"), 0u);
    EXPECT_EQ(outcome.count("rejected"), kind == Gate::Kind::fixed ? 1u : 0u);  // believed again
    EXPECT_LT(outcome.worst(20.0, 30.0), 0.5);
  }
}

}  // namespace
}  // namespace fathom
