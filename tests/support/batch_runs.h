#pragma once

#include <memory>

#include "estimation/batch_estimate.h"
#include "estimation/linearization.h"
#include "sensors/camera_geometry.h"
#include "simulation/navigation_simulator.h"
#include "support/detections.h"
#include "support/motions.h"
#include "support/shipped.h"
#include "support/streams.h"

/// Recordings for the batch estimate: navigation sensors simulated, markers' corners straight from the
/// camera's forward model, without an image.
namespace fathom::test {

/// 2 to 4 m before a panel at x = 6 m: turning, sidling, diving; a second a period of the fastest part.
inline Pose beforePanel(double t) {
  return {rotationFromYawPitchRoll(0.25 * std::sin(0.43 * t), 0.1 * std::sin(0.61 * t),
                                   0.12 * std::sin(0.83 * t + 0.4)),
          Vector3d(3.0 + 0.8 * std::sin(0.29 * t), 0.9 * std::sin(0.37 * t + 1.0),
                   -4.0 + 0.5 * std::sin(0.47 * t))};
}

inline Trajectory pathBeforePanel(double duration_s) {
  const auto times_s = timesBetween(0, duration_s, 0.1);
  std::vector<Pose> poses(times_s.size());
  std::transform(times_s.begin(), times_s.end(), poses.begin(), beforePanel);
  return {times_s, poses};
}

struct BatchRun {
  Vehicle vehicle;
  EffectParameters<double> effects;  ///< what is true
  double duration_s;
  bool noise = true;
  double corner_sigma_px = 0.15;
  std::uint64_t seed = 1;
  PanelMap panel;       ///< as the map has it
  bool pixels = false;  ///< black and white of each marker, straight from the forward model of light

  // What no effect describes.
  std::optional<PanelMap> true_panel;  ///< where it is not as the map has it
  double corner_tail_dof = 0;          ///< of Student's t instead of a normal, of the same sigma; 0: normal
  double camera_shake_rad = 0;         ///< the mounting turns anew with every image; one axis

  explicit BatchRun(double seconds = 40.0) : BatchRun(seconds, pathBeforePanel(seconds + 10.0)) {}
  /// The path begins 4 s before the recording and goes on for 4 s or more after it.
  BatchRun(double seconds, Trajectory path);

  std::vector<Sample> samples() const;
  Detections detections() const;
  std::vector<ImagePatch> patches() const;
  BatchInput input(const EffectParameters<double>& calibration = {}) const;
  void addPatches(BatchInput& input) const;
  /// The robot's pose t_s after the first entry.
  Pose truth(double t_s) const {
    const auto state = path_.at(kBegin_s + t_s);
    return {state.R_odom_robot, state.position_odom};
  }

 private:
  static constexpr double kBegin_s = 4.0;  ///< the path's own beginning has no acceleration
  SimulationOptions options() const;
  Vector8d cornerErrors(Random& random) const;
  Trajectory path_;
};

inline BatchRun::BatchRun(double seconds, Trajectory path) : duration_s(seconds), path_(std::move(path)) {
  vehicle = readVehicle(kRov);
  panel = gridPanel(4, 3);
  panel.name = "grid";
  panel.T_odom_panel = {rotationFromYawPitchRoll(radians(-90), 0, radians(90)), {6.0, 0.0, -4.0}};
}

inline SimulationOptions BatchRun::options() const {
  SimulationOptions simulation;
  simulation.vehicle = vehicle;
  simulation.effects = effects;
  simulation.sea_floor_z_m = -9.0;
  simulation.seed = seed;
  simulation.noise = noise;
  simulation.begin_s = kBegin_s;
  simulation.duration_s = duration_s;
  simulation.images = true;
  return simulation;
}

inline std::vector<Sample> BatchRun::samples() const {
  std::vector<Sample> samples;
  simulateNavigation(options(), path_, [&](const Sample& sample) { samples.push_back(sample); });
  return samples;
}

/// Of sigma 1, not correlated. The tails are a corner's, not a coordinate's.
inline Vector8d BatchRun::cornerErrors(Random& random) const {
  Vector8d error;
  for (double& e : error) e = noise ? random.normal() : 0.0;
  if (corner_tail_dof <= 0) return error;
  for (Eigen::Index k = 0; k < 8; k += 2) {
    double chi_square = 0;
    for (int i = 0; i < static_cast<int>(corner_tail_dof); ++i) chi_square += std::pow(random.normal(), 2);
    error.segment<2>(k) *= std::sqrt((corner_tail_dof - 2.0) / chi_square);
  }
  return error;
}

inline Detections BatchRun::detections() const {
  Detections detections;
  if (!vehicle.camera) return detections;
  const SimulationOptions simulation = options();
  const CameraSheet& sheet = *vehicle.camera;
  Random random = Random::stream(seed, 77), shaking = Random::stream(seed, 78);
  const std::vector<Marker>& markers = true_panel ? true_panel->markers : panel.markers;
  const Matrix8d C = cornerCovariance(corner_sigma_px);
  const Matrix8d root = C.llt().matrixL();
  for (std::size_t image = 0;; ++image) {
    const double t_s = secondsBetween(simulation.start, imageTime(simulation, image));
    if (t_s > duration_s) return detections;
    const auto state = path_.at(simulation.begin_s + t_s + validityOffset<Sensor::camera>(effects, t_s));
    auto& found = detections.by_file["/images/" + imageFiles(sheet, {}, image)[0]];
    Pose T_robot_camera = sheet.T_robot_camera;
    T_robot_camera.rotation *= expSO3<double>(camera_shake_rad * shaking.normal3());
    for (const Marker& marker : markers) {
      const auto corners = predictCorners(state, nominalPlacement<double>(panel.T_odom_panel, t_s), marker,
                                          sheet.model, T_robot_camera, effects, t_s);
      const Vector8d error = root * cornerErrors(random);
      const bool visible = std::all_of(corners.begin(), corners.end(),
                                       [&](const Vector2d& c) { return sheet.model.contains(c); });
      if (!visible) continue;
      Detection detection;
      detection.family = marker.family;
      detection.id = marker.id;
      detection.covariance_px2 = C;
      for (std::size_t k = 0; k < 4; ++k)
        detection.corners_px[k] = corners[k] + error.segment<2>(static_cast<Eigen::Index>(2 * k));
      found.push_back(detection);
    }
  }
}

/// A coastal water, as waterParameters().
inline Vector9d coastalWater() {
  Vector9d water;
  water << 0.38, 0.2, 0.18, 0.04, 0.19, 0.21, 0.79, 0.86, 0.84;
  return water;
}

/// Of the markers that are detected: two patches each, with noise as of 100 pixels.
inline std::vector<ImagePatch> BatchRun::patches() const {
  constexpr double kSigma = 0.0003;
  const SimulationOptions simulation = options();
  const CameraSheet& sheet = *vehicle.camera;
  Random random = Random::stream(seed, 79);
  std::vector<ImagePatch> patches;
  for (std::size_t image = 0;; ++image) {
    ImagePatch patch;
    patch.t_s = secondsBetween(simulation.start, imageTime(simulation, image));
    if (patch.t_s > duration_s) return patches;
    patch.image = image;
    patch.T_robot_camera = sheet.T_robot_camera;
    patch.sigma.setConstant(kSigma);
    const auto state =
        path_.at(simulation.begin_s + patch.t_s + validityOffset<Sensor::camera>(effects, patch.t_s));
    const Pose T_camera_panel =
        (Pose{state.R_odom_robot, state.position_odom} * sheet.T_robot_camera).inverse() * panel.T_odom_panel;
    for (const Marker& marker : panel.markers) {
      patch.point_panel = marker.T_panel_marker.position;
      const Vector3d point = T_camera_panel * patch.point_panel;
      if (point.z() < 0.1 || !sheet.model.contains(sheet.model.project<double>(point))) continue;
      patch.pixel = sheet.model.project<double>(point);
      patch.image_radius = point.head<2>().norm() / point.z();
      for (const bool white : {false, true}) {
        patch.place = 2 * marker.id + (white ? 1 : 0);
        patch.albedo.setConstant(white ? panel.white_albedo : panel.black_albedo);
        patch.radiance = predictPatch(state, nominalPlacement<double>(panel.T_odom_panel, patch.t_s), patch,
                                      coastalWater(), effects, patch.t_s);
        if (noise) patch.radiance += kSigma * random.normal3();
        patches.push_back(patch);
      }
    }
  }
}

inline BatchInput BatchRun::input(const EffectParameters<double>& calibration) const {
  const std::vector<Sample> all = samples();
  BatchInput input =
      batchInput([&]() -> std::unique_ptr<SampleSource> { return std::make_unique<ListSource>(all); },
                 detections(), vehicle, {panel}, calibration);
  addPatches(input);
  return input;
}

/// The fit starts a little off.
inline void BatchRun::addPatches(BatchInput& input) const {
  if (!pixels) return;
  input.data.patches = patches();
  input.data.water = environmentOf(1.02 * coastalWater());
}

}  // namespace fathom::test
