#pragma once

#include <array>
#include <string>

#include "core/geometry.h"

/// What the vehicle's data sheets say: all that a sealed recording tells about it.
namespace fathom::sealed {

struct Mounting {
  double x, y, z, yaw_deg, pitch_deg, roll_deg;

  Pose pose() const {
    return {rotationFromYawPitchRoll(radians(yaw_deg), radians(pitch_deg), radians(roll_deg)), {x, y, z}};
  }
};

struct Ins {
  double rate_hz = 100;
  double gyro_sigma_rad_s = 0.001, accelerometer_sigma_m_s2 = 0.01;  ///< white, each sample
  double gyro_bias_sigma_rad_s = 0.00005, accelerometer_bias_sigma_m_s2 = 0.003;
  double bias_time_constant_s = 120;
  Mounting pose{0.05, -0.02, 0.03, 0, 0, 0};
};

struct Dvl {
  double rate_hz = 5;
  double assumed_sound_speed_m_s = 1500;
  double beam_sigma_m_s = 0.007;
  double velocity_sigma_xy_m_s = 0.0099, velocity_sigma_z_m_s = 0.00404;
  double range_sigma_m = 0.015;
  double beam_angle_deg = 30;
  std::array<double, 4> beam_azimuths_deg{0, 90, 180, 270};
  Mounting pose{-0.2, 0.05, -0.18, 45, 0, 0};
};

struct DepthGauge {
  double rate_hz = 5;
  double pressure_sigma_pa = 100, pressure_offset_sigma_pa = 100;
  double atmospheric_pressure_pa = 101325;
  double water_density_kg_m3 = 1025;
  Mounting pose{-0.1, 0.1, 0.1, 0, 0, 0};
};

struct Camera {
  double rate_hz = 1;
  int width_px = 640, height_px = 480;
  double fx_px = 555.1962, fy_px = 555.2854, cx_px = 321.1975, cy_px = 244.7355;
  double k1 = -0.041737, k2 = -0.023008, p1 = -0.000173, p2 = 0.000823, k3 = 0.0;
  double exposure_s = 0.004;
  double response_gamma = 1.0;
  double full_well_e = 30000, read_noise_e = 12;
  double corner_sigma_px = 0.15;
  Mounting pose{0.35, 0, 0.05, -90, 0, -92};
};

struct Lamp {
  const char* name;
  double half_angle_deg;  ///< off the axis, where it is half as bright
  Mounting pose;          ///< light leaves along x
};

struct Vehicle {
  double gravity_m_s2 = 9.80665;
  Ins ins{};
  Dvl dvl{};
  DepthGauge depth{};
  Camera camera{};
  std::array<Lamp, 2> lamps{
      {{"port", 32, {0.33, 0.28, 0.14, -6, 3, 0}}, {"starboard", 32, {0.33, -0.28, 0.14, 6, 3, 0}}}};
};

/// The vehicle file, as recording.md has it.
std::string vehicleYaml(const Vehicle& vehicle);

}  // namespace fathom::sealed
