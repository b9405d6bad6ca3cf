#pragma once

#include <functional>

#include "localization/evaluation.h"
#include "localization/localizer.h"
#include "simulation/navigation_simulator.h"
#include "support/motions.h"

namespace fathom::test {

/// A run of the filter before panels: navigation sensors simulated, sightings drawn from the truth with known
/// noise, without an image.
struct LandmarkRun {
  SimulationOptions simulation;
  std::vector<Pose> panels{{rotationFromYawPitchRoll(0.0, 0.0, radians(90)), {5.0, 0.0, -4.0}}};
  double sighting_rate_hz = 2.0;
  double sighting_sigma_m = 0.01, sighting_sigma_rad = radians(0.5);  ///< robot axes; panel axes
  double wrong_start_m = 0.0, wrong_start_rad = 0.0;  ///< the start pose given is off by so much
  double start_error = 1.0;                           ///< random error of the start pose given, in its sigmas
  bool start_is_given = true;
  /// The frame that fixes and truth are told in, seen from the simulation's: upright, at its height.
  Pose T_odom_simulated;
  LocalizationOptions options;
  std::vector<PanelPrior> priors;  ///< empty: all exact
  std::uint64_t seed = 1;

  /// Where a panel truly is.
  std::function<Pose(std::size_t panel, double t_s)> T_odom_panel = [this](std::size_t panel, double) {
    return panels[panel];
  };
  /// Whether it is in view.
  std::function<bool(std::size_t panel, double t_s)> sees = [](std::size_t, double) { return true; };
  /// What else happens to a sample before it is fused; false: it is left out.
  std::function<bool(Sample&, double t_s, Random&)> fault = [](Sample&, double, Random&) { return true; };

  /// Another order of arrival; absent: by time.
  std::function<void(std::vector<Sample>& samples, const Time& zero)> arrange;

  LandmarkRun();
  LandmarkRun(const LandmarkRun&) = delete;
  struct Outcome;
  Outcome run(double duration_s) const;
};

struct LandmarkRun::Outcome {
  LocalizationSummary summary;
  std::vector<Estimate> estimates, smoothed;
  std::vector<Innovation> innovations;
  std::vector<Event> events;
  std::vector<StampedPose> truth;

  std::size_t count(const std::string& kind) const {
    const auto found = summary.event_counts.find(kind);
    return found == summary.event_counts.end() ? 0 : found->second;
  }
  const Event* first(const std::string& kind) const {
    const auto found =
        std::find_if(events.begin(), events.end(), [&](const Event& e) { return e.kind == kind; });
    return found == events.end() ? nullptr : &*found;
  }
  Vector6d error(const Estimate& e) const {
    const auto& m = e.state.motion;
    return poseDifference(*poseAt(truth, e.time), {m.R_odom_robot, m.position_odom});
  }
  /// Largest position error, m, of the estimates from one time to another.
  double worst(double from_s, double to_s) const {
    double worst_m = 0.0;
    for (const Estimate& e : estimates)
      if (e.t_s >= from_s && e.t_s <= to_s) worst_m = std::max(worst_m, error(e).head<3>().norm());
    return worst_m;
  }
};

inline LandmarkRun::LandmarkRun() {
  simulation.vehicle = readVehicle(std::filesystem::path(FATHOM_SOURCE_DIR) / "config/rov.yaml");
  simulation.vehicle.ins->rate_hz =
      20.0;  // what is tested does not depend on it, and it is five times faster
  simulation.vehicle.camera.reset();
  simulation.sea_floor_z_m = -9.0;
  options.output_rate_hz = 2.0;
}

inline auto LandmarkRun::run(double duration_s) const -> Outcome {
  Random random = Random::stream(seed, 99);
  SimulationOptions simulated = simulation;
  simulated.duration_s = duration_s;
  simulated.begin_s = 5.0;
  simulated.seed = seed;
  const Trajectory trajectory = sineTrajectory(duration_s + 10.0);
  std::vector<Sample> samples;
  Outcome outcome;
  simulateNavigation(simulated, trajectory, [&](const Sample& sample) {
    if (sample.label == labels::kTruth)
      outcome.truth.push_back(
          {sample.time, T_odom_simulated * std::get<PoseSample>(sample.reading).T_odom_robot.mean});
    else
      samples.push_back(sample);
    if (sample.label == labels::kUsbl) {
      Vector3d& seen = std::get<PoseSample>(samples.back().reading).T_odom_robot.mean.position;
      seen = T_odom_simulated * seen;
    }
  });
  const Time zero = samples.front().time;
  Vector6d variance;
  variance << Vector3d::Constant(sighting_sigma_m * sighting_sigma_m),
      Vector3d::Constant(sighting_sigma_rad * sighting_sigma_rad);
  const Pose T_robot_camera{rotationFromYawPitchRoll(radians(-90), 0, radians(-92)), {0.35, 0, 0.05}};
  for (double t = 0.25; t < duration_s; t += 1.0 / sighting_rate_hz) {
    const KinematicState<double> truth = trajectory.at(t + simulated.begin_s);
    PanelSample sample{T_robot_camera, {}};
    for (std::size_t i = 0; i < panels.size(); ++i) {
      // Drawn in any case: what is out of view changes no other sighting.
      const Vector3d shift = sighting_sigma_m * random.normal3(),
                     turn = sighting_sigma_rad * random.normal3();
      if (!sees(i, t)) continue;
      UncertainPose seen{T_robot_camera.inverse() *
                         (Pose{truth.R_odom_robot, truth.position_odom}.inverse() * T_odom_panel(i, t))};
      seen.pose.position += shift;
      seen.pose.rotation = seen.pose.rotation * expSO3<double>(turn);
      seen.covariance = variance.asDiagonal();
      sample.panels.push_back({static_cast<int>(i), seen});
    }
    if (sample.panels.empty()) continue;
    samples.push_back({after(zero, t), labels::kPanel, sample});
    // Of the same image: the robot's pose by the first panel's map, as markers give it.
    const SeenPanel& seen = sample.panels.front();
    const Pose T_odom_robot = T_odom_simulated * panels[static_cast<std::size_t>(seen.panel)] *
                              (T_robot_camera * seen.T_camera_panel.pose).inverse();
    samples.push_back({after(zero, t), labels::kMarkers, PoseSample{{T_odom_robot}}});
  }
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.time < b.time; });

  LocalizationSetup setup;
  setup.vehicle = simulation.vehicle;
  setup.options = options;
  setup.options.fuse.push_back(kChannel<Landmark>);
  setup.time_zero = zero;
  setup.panels = priors;
  for (std::size_t i = priors.size(); i < panels.size(); ++i)
    setup.panels.push_back({std::string("P").append(std::to_string(i)), T_odom_simulated * panels[i]});
  StartPose start{outcome.truth.front().T_odom_robot};
  start.T_odom_robot.position += start_error * start.position_sigma_m * random.normal3();
  start.T_odom_robot.rotation =
      start.T_odom_robot.rotation * expSO3<double>(start_error * start.angle_sigma_rad * random.normal3());
  start.T_odom_robot.position.x() += wrong_start_m;
  start.T_odom_robot.rotation = rotationFromYawPitchRoll(wrong_start_rad, 0, 0) * start.T_odom_robot.rotation;
  if (start_is_given) setup.start = start;

  LocalizationSink sink;
  sink.estimate = [&](const Estimate& e) { outcome.estimates.push_back(e); };
  sink.smoothed = [&](const Estimate& e) { outcome.smoothed.push_back(e); };
  sink.innovation = [&](const Innovation& i) { outcome.innovations.push_back(i); };
  sink.event = [&](const Event& e) { outcome.events.push_back(e); };
  Localizer localizer(setup, sink);
  if (arrange) arrange(samples, zero);
  for (Sample& sample : samples)
    if (fault(sample, secondsBetween(zero, sample.time), random)) localizer.add(sample);
  outcome.summary = localizer.finish();
  return outcome;
}

}  // namespace fathom::test
