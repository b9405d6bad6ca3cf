#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/geometry.h"
#include "core/yaml.h"

/// The vehicle file: what an engineer knows of the robot from data sheets and drawings. See config/rov.yaml.
namespace fathom {

struct InsSheet {
  double rate_hz = 100;
  double gyro_sigma_rad_s = 0.001;              ///< white, each sample
  double accelerometer_sigma_m_s2 = 0.01;       ///< white, each sample
  double gyro_bias_sigma_rad_s = 5e-5;          ///< stationary sigma of a first-order Gauss-Markov process
  double accelerometer_bias_sigma_m_s2 = 3e-3;  ///< likewise
  double bias_time_constant_s = 120;
  /// Optional key: sigma of the attitude, where the INS gives one; absent, its attitude is used for the start
  /// only.
  std::optional<double> attitude_sigma_rad;
  Pose T_robot_ins;
};

struct DvlSheet {
  double rate_hz = 5;
  double assumed_sound_speed_m_s = 1500;
  double beam_sigma_m_s = 0.007;
  double velocity_sigma_xy_m_s = 0.0099;
  double velocity_sigma_z_m_s = 0.00404;
  double range_sigma_m = 0.015;
  double beam_angle_rad = radians(30);                                                ///< from straight down
  std::vector<double> beam_azimuths_rad{0, radians(90), radians(180), radians(270)};  ///< DVL frame
  Pose T_robot_dvl;

  /// Beam k's frame on the robot: x along the beam, down and out. The one place that knows the Janus
  /// geometry.
  Pose T_robot_beam(std::size_t k) const;
};

struct DepthSheet {
  double rate_hz = 5;
  double pressure_sigma_pa = 100;
  double pressure_offset_sigma_pa = 100;
  double atmospheric_pressure_pa = 101325;
  double water_density_kg_m3 = 1025;
  Pose T_robot_depth;
};

/// Optional section `usbl`: position of the transponder.
struct UsblSheet {
  double rate_hz = 0.2;
  double position_sigma_m = 0.5;  ///< each axis
  Pose T_robot_usbl;
};

struct CameraSheet {
  double rate_hz = 1;
  CameraModel model;
  double exposure_s = 0.004;
  std::string gain = "fixed";
  double response_gamma = 1.0;
  int bits = 8;
  double full_well_e = 30000;
  double read_noise_e = 12;
  double corner_sigma_px = 0.15;
  Pose T_robot_camera;
  /// Optional key `right_pose`: a second camera of the same kind makes it a stereo pair; the right one's
  /// frame in the left one's.
  std::optional<Pose> T_left_right;
  /// Optional key `right_pose_sigma: {position_m, angle_deg}`, each axis: how well a pair's mounting is
  /// known.
  double right_position_sigma_m = 0.001, right_angle_sigma_rad = radians(0.1);
  /// Optional key `right_window`, as `window` of the left one, which is model.window: {distance_m, tilt_deg,
  /// tilt_y_deg}.
  Window right_window;
};

struct LampSheet {
  std::string name;
  double half_angle_rad = 0;
  Pose T_robot_lamp;  ///< light leaves along x
};

/// A sensor whose section is absent is not on board.
struct Vehicle {
  double gravity_m_s2 = 9.80665;
  std::optional<InsSheet> ins;
  std::optional<DvlSheet> dvl;
  std::optional<DepthSheet> depth;
  std::optional<UsblSheet> usbl;
  std::optional<CameraSheet> camera;
  std::vector<LampSheet> lamps;

  Vector3d gravityOdom() const { return {0, 0, -gravity_m_s2}; }
};

/// Strict, see core/yaml.h. Throws Error.
Vehicle readVehicle(const std::filesystem::path& file);

/// A camera's fx_px, fy_px, cx_px, cy_px, wherever they stand. Throws Error.
void readPinhole(const YamlMap& y, CameraModel& camera);

}  // namespace fathom
