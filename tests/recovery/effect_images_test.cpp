// Each marker-geometry effect, simulated as images: markers are found where the forward model says, and a
// calibration that knows the effect gives back the robot's pose.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/files.h"
#include "fiducials/single_marker_pose.h"
#include "imaging/detected_corners.h"
#include "landmarks/landmark_source.h"
#include "render/scene.h"
#include "simulation/image_simulator.h"
#include "simulation/read_trajectory.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

/// Before the panel, swaying enough that it matters when a row is read.
const std::string kSwaying =
    ", y: 0.05, z: -4.25, yaw_deg: 1}\nduration_s: 20\nsway:\n"
    "  - {axis: y, amplitude_m: 0.3, period_s: 7}\n  - {axis: roll, amplitude_deg: 4, period_s: 5}\n"
    "  - {axis: pitch, amplitude_deg: 3, period_s: 6}\n  - {axis: yaw, amplitude_deg: 6, period_s: 5}\n";

/// One image of the shipped panel in clear water, without noise.
class EffectImages : public testing::Test {
 protected:
  EffectImages() : folder_(test::scratchFolder()) {
    standAt(4.3);
    options_.vehicle = readVehicle(test::kRov);
    options_.begin_s = 6.2;
    options_.duration_s = 0.5;
    options_.noise = false;
    options_.images = true;
    world_.panels = {readPanelMap(test::kDexrovMap)};
    world_.sea_floor_odom = seaFloorBelow(world_.panels, -6, Random(1));
    world_.environment = readEnvironment(test::kSource / "config/water_clear.yaml");
  }

  void standAt(double x_m) {
    writeTextFile(folder_ / "path.yaml", "kind: station\npose: {x: " + std::to_string(x_m) + kSwaying);
    trajectory_ = readTrajectory(folder_ / "path.yaml");
  }

  struct Found {
    double rms_px = 0, largest_px = 0, without_px = 0;  ///< without: by the nominal model, at the stamp
    int corners = 0;
    double joint_m = 0, mean_m = 0, without_m = 0;  ///< error of the robot's position
  };

  Found simulated(const EffectParameters<double>& effects, bool stereo = false) {
    options_.effects = effects;
    if (stereo) options_.vehicle.camera->T_left_right = Pose{Matrix3d::Identity(), {0.1, 0, 0}};
    simulateImages(options_, *trajectory_, world_, folder_ / "images");
    const CameraSheet& sheet = *options_.vehicle.camera;
    ImageEntry entry{options_.start, {}, sheet.T_robot_camera, {}, {}, {}};
    Detections detections;
    DetectorOptions with_lens;
    with_lens.camera = sheet.model;
    const auto detector = makeDetector(Backend::aruco, settingsFor(world_.panels).families, with_lens);
    for (const auto& name : imageFiles(sheet, options_.image_format, 0)) {
      const fs::path file = folder_ / "images" / name;
      entry.eyes.push_back({{file, sheet.model}, entry.eyes.empty() ? Pose{} : *sheet.T_left_right});
      detections.by_file[file] = detector->detect(cv::imread(file.string()));
    }
    const double valid_s = options_.begin_s + validityOffset<Camera>(effects, 0);
    const KinematicState<double> at_stamp = trajectory_->at(options_.begin_s),
                                 state = trajectory_->at(valid_s);
    entry.velocity_robot = state.velocity_robot;
    entry.angular_velocity_robot = state.angular_velocity_robot;
    Found found;
    for (const auto& eye : entry.eyes)
      judgeCorners(detections.by_file.at(eye.image.file), state, at_stamp, eye.T_first_camera, found);
    const auto errorOf = [&](const PanelSample& seen, const KinematicState<double>& truth) {
      const Pose& T_odom_panel = world_.panels[0].T_odom_panel;
      const auto T_odom_robot = robotPose(seen.panels[0].T_camera_panel, T_odom_panel, seen.T_robot_camera);
      return (T_odom_robot.pose.position - truth.position_odom).norm();
    };
    const auto solve = [&](const LandmarkCalibration& calibration) {
      return solveSightings({entry}, detections, world_.panels, calibration).by_entry.at(0);
    };
    const Sighting with = solve({effects, options_.start}), without = solve({});
    if (with.panels.panels.empty() || without.panels.panels.empty()) return found;
    found.joint_m = errorOf(with.panels, state);
    found.without_m = errorOf(without.panels, at_stamp);
    found.mean_m = (with.robot->T_odom_robot.mean.position - state.position_odom).norm();
    return found;
  }

 private:
  void judgeCorners(const std::vector<Detection>& detections, const KinematicState<double>& state,
                    const KinematicState<double>& at_stamp, const Pose& T_left_eye, Found& found) {
    const CameraSheet& sheet = *options_.vehicle.camera;
    const auto panel = nominalPlacement<double>(world_.panels[0].T_odom_panel, 0);
    double squares = 0, without = 0;
    int corners = 0;
    for (const Detection& detection : detections) {
      const Marker* marker = markerOf(detection, world_.panels[0]);
      if (marker == nullptr) continue;
      const auto predicted = [&](const KinematicState<double>& motion,
                                 const EffectParameters<double>& effects) {
        const Vector3d centre_odom = world_.panels[0].T_odom_panel * marker->T_panel_marker.position;
        const Pose T_odom_camera = Pose{motion.R_odom_robot, motion.position_odom} * sheet.T_robot_camera;
        const double z_m = (T_odom_camera.inverse() * centre_odom).z();
        const EdgeLight light = edgeLight(world_.panels[0], world_.environment, z_m, sheet.response_gamma);
        return predictDetectedCorners(motion, panel, *marker, sheet.model, sheet.T_robot_camera, light,
                                      effects, 0, T_left_eye);
      };
      const auto with = predicted(state, options_.effects), nominal = predicted(at_stamp, {});
      for (std::size_t k = 0; k < 4; ++k, ++corners) {
        const double error = (detection.corners_px[k] - with[k]).norm();
        squares += error * error;
        without += (detection.corners_px[k] - nominal[k]).squaredNorm();
        found.largest_px = std::max(found.largest_px, error);
      }
    }
    found.rms_px = std::max(found.rms_px, std::sqrt(squares / corners));
    found.without_px = std::sqrt(without / corners);
    found.corners += corners;
  }

  fs::path folder_;
  std::optional<Trajectory> trajectory_;
  SimulationOptions options_;
  CameraWorld world_;
};

struct Case {
  const char* name;
  double seen_px;  ///< what the nominal model is off by, at least
  double wrong_m;  ///< what the robot's position is off by without the calibration, at least
  EffectParameters<double> effects;
};

template <class Effect>
Case only(double seen_px, double wrong_m, const std::array<double, parameterSize<Effect>()>& values) {
  Case result{Effect::id.data(), seen_px, wrong_m, {}};
  result.effects.add<Effect>(values);
  return result;
}

/// The detector finds corners to 0.02 px here, and to 0.3 where something bends their edges.
void expectFound(const Case& effect, const auto& found, double rms_px = 0.1, double largest_px = 0.3) {
  EXPECT_GE(found.corners, 16) << effect.name;
  EXPECT_LT(found.rms_px, rms_px) << effect.name;
  EXPECT_LT(found.largest_px, largest_px) << effect.name;
  EXPECT_GE(found.without_px, effect.seen_px) << effect.name;
  EXPECT_LT(found.joint_m, 0.003) << effect.name;
  EXPECT_LT(found.mean_m, 0.03) << effect.name;
  EXPECT_GE(found.without_m, effect.wrong_m) << effect.name;
}

TEST_F(EffectImages, MarkersAreWhereTheForwardModelSays) {
  const std::array<Case, 12> cases{Case{"nominal", 0, 0, {}},
                                   only<FlatPortRefraction>(1, 0.005, {0.08, 0.01, 2, -1, 0}),
                                   only<DecentredDome>(1, 0.005, {-0.005, 0.003, 0.02, 0.1, 0.2}),
                                   only<FocalScale>(3, 0.02, {0.03}),
                                   only<LensDistortion>(1, 0.002, {0.1, 0.05, 0.002, -0.002}),
                                   only<CameraMisalignment>(8, 0.005, {1, -1, 2}),
                                   only<CameraLatency>(8, 0.02, {0.2}),
                                   only<RollingShutter>(2, 0.005, {0.06}),
                                   only<MarkerMoved>(0.5, 0, {618, 0.02, -0.01, 0, 5}),
                                   only<MarkerSize>(0.5, 0, {0.05}),
                                   only<PanelShape>(0.5, 0, {0.01, -0.005, 0.005, 1, 0.005, -0.01}),
                                   only<PanelMoved>(8, 0.05, {-1, 0.1, 0.02, -0.05, 0, 5, 0})};
  for (const Case& effect : cases) expectFound(effect, simulated(effect.effects));
}

/// A camera calibrated in air, under water: everything is a third larger, and markers' edges are so bent that
/// the detector, which fits straight ones, errs by some tenths of a pixel.
TEST_F(EffectImages, ACameraCalibratedInAirSeesThroughItsPort) {
  standAt(3.6);
  const Case effect = only<FlatPortRefraction>(20, 0.3, {0.03, 0.01, 0.5, 0, 0.34});
  expectFound(effect, simulated(effect.effects), 0.5, 1.0);
}

/// White spreads over black: by a tenth of a pixel, to a fifth of that.
TEST_F(EffectImages, AnotherResponseShiftsMarkersEdges) {
  const Found found = simulated(only<Gamma>(0, 0, {-0.4}).effects);
  EXPECT_GE(found.corners, 16);
  EXPECT_GT(found.without_px, 0.1);
  EXPECT_LT(found.rms_px, 0.05);
}

/// Either way, to a fifth of how far corners move.
TEST_F(EffectImages, WhiteThatGrowsShiftsMarkersEdges) {
  for (const double offset_px : {0.3, -0.3}) {
    const Found found = simulated(only<EdgeBias>(0, 0, {offset_px}).effects);
    EXPECT_GE(found.corners, 16) << offset_px;
    EXPECT_GT(found.without_px, 0.35) << offset_px;
    EXPECT_LT(found.rms_px, 0.08) << offset_px;
    EXPECT_LT(found.joint_m, 0.003) << offset_px;
  }
}

TEST_F(EffectImages, APairSeesAllEffectsAtOnce) {
  Case effect = only<FlatPortRefraction>(5, 0.005, {0.05, 0.01, 1, 0, 0});
  effect.effects.add<FocalScale>({0.02});
  effect.effects.add<CameraMisalignment>({1, 0.5, -1});
  effect.effects.add<RollingShutter>({0.03});
  effect.effects.add<MarkerSize>({0.02});
  effect.effects.add<CameraLatency>({0.1});
  expectFound(effect, simulated(effect.effects, true));
}

}  // namespace
}  // namespace fathom
