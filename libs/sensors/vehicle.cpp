#include "sensors/vehicle.h"

#include <cmath>

namespace fathom {
namespace {

InsSheet readIns(const YamlMap& y) {
  InsSheet s;
  s.rate_hz = y.positive("rate_hz");
  s.gyro_sigma_rad_s = y.positive("gyro_sigma_rad_s");
  s.accelerometer_sigma_m_s2 = y.positive("accelerometer_sigma_m_s2");
  s.gyro_bias_sigma_rad_s = y.notNegative("gyro_bias_sigma_rad_s");
  s.accelerometer_bias_sigma_m_s2 = y.notNegative("accelerometer_bias_sigma_m_s2");
  s.bias_time_constant_s = y.positive("bias_time_constant_s");
  if (y.has("attitude_sigma_deg")) s.attitude_sigma_rad = radians(y.positive("attitude_sigma_deg"));
  s.T_robot_ins = y.pose("pose");
  return s;
}

DvlSheet readDvl(const YamlMap& y) {
  DvlSheet s;
  s.rate_hz = y.positive("rate_hz");
  s.assumed_sound_speed_m_s = y.positive("assumed_sound_speed_m_s");
  s.beam_sigma_m_s = y.positive("beam_sigma_m_s");
  s.velocity_sigma_xy_m_s = y.positive("velocity_sigma_xy_m_s");
  s.velocity_sigma_z_m_s = y.positive("velocity_sigma_z_m_s");
  s.range_sigma_m = y.positive("range_sigma_m");
  s.beam_angle_rad = radians(y.positive("beam_angle_deg"));
  if (s.beam_angle_rad >= radians(90)) throw y.error("beam_angle_deg", "must be below 90");
  s.beam_azimuths_rad.clear();
  for (const double azimuth_deg : y.numbers("beam_azimuths_deg"))
    s.beam_azimuths_rad.push_back(radians(azimuth_deg));
  s.T_robot_dvl = y.pose("pose");
  return s;
}

DepthSheet readDepth(const YamlMap& y) {
  DepthSheet s;
  s.rate_hz = y.positive("rate_hz");
  s.pressure_sigma_pa = y.positive("pressure_sigma_pa");
  s.pressure_offset_sigma_pa = y.notNegative("pressure_offset_sigma_pa");
  s.atmospheric_pressure_pa = y.positive("atmospheric_pressure_pa");
  s.water_density_kg_m3 = y.positive("water_density_kg_m3");
  s.T_robot_depth = y.pose("pose");
  return s;
}

UsblSheet readUsbl(const YamlMap& y) {
  UsblSheet s;
  s.rate_hz = y.positive("rate_hz");
  s.position_sigma_m = y.positive("position_sigma_m");
  s.T_robot_usbl = y.pose("pose");
  return s;
}

Window readWindow(const YamlMap& y) {
  const Window window{y.notNegative("distance_m"), radians(y.number("tilt_deg")),
                      radians(y.number("tilt_y_deg"))};
  if (std::hypot(window.tilt_x_rad, window.tilt_y_rad) > radians(80))
    throw y.error("tilt_deg", "the window must be before the camera");
  return window;
}

CameraSheet readCamera(const YamlMap& y) {
  CameraSheet s;
  s.rate_hz = y.positive("rate_hz");
  s.model.width_px = y.integer("width_px");
  s.model.height_px = y.integer("height_px");
  if (s.model.width_px <= 0 || s.model.height_px <= 0)
    throw y.error("width_px", "image size must be greater than zero");
  readPinhole(y, s.model);
  const YamlMap d = y.map("distortion");
  s.model.k1 = d.number("k1");
  s.model.k2 = d.number("k2");
  s.model.p1 = d.number("p1");
  s.model.p2 = d.number("p2");
  s.model.k3 = d.number("k3");
  s.exposure_s = y.positive("exposure_s");
  s.gain = y.text("gain");
  if (s.gain != "fixed" && s.gain != "auto") throw y.error("gain", "must be fixed or auto");
  s.response_gamma = y.positive("response_gamma");
  s.bits = y.integer("bits");
  if (s.bits < 1 || s.bits > 16) throw y.error("bits", "must be from 1 to 16");
  s.full_well_e = y.positive("full_well_e");
  s.read_noise_e = y.notNegative("read_noise_e");
  s.corner_sigma_px = y.positive("corner_sigma_px");
  s.T_robot_camera = y.pose("pose");
  if (y.has("window")) s.model.window = readWindow(y.map("window"));
  if (!y.has("right_pose")) return s;
  s.T_left_right = y.pose("right_pose");
  if (y.has("right_window")) s.right_window = readWindow(y.map("right_window"));
  if (y.has("right_pose_sigma")) {
    const YamlMap sigma = y.map("right_pose_sigma");
    s.right_position_sigma_m = sigma.positive("position_m");
    s.right_angle_sigma_rad = radians(sigma.positive("angle_deg"));
  }
  return s;
}

LampSheet readLamp(const YamlMap& y) {
  LampSheet s;
  s.name = y.text("name");
  s.half_angle_rad = radians(y.positive("half_angle_deg"));
  s.T_robot_lamp = y.pose("pose");
  return s;
}

}  // namespace

Pose DvlSheet::T_robot_beam(std::size_t k) const {
  // x along the beam: from straight down (-z of the DVL), beam_angle outwards at the azimuth.
  const double azimuth = beam_azimuths_rad.at(k);
  const Pose T_dvl_beam{rotationFromYawPitchRoll(azimuth, radians(90) - beam_angle_rad, 0), Vector3d::Zero()};
  return T_robot_dvl * T_dvl_beam;
}

void readPinhole(const YamlMap& y, CameraModel& camera) {
  camera.fx_px = y.positive("fx_px");
  camera.fy_px = y.positive("fy_px");
  camera.cx_px = y.number("cx_px");
  camera.cy_px = y.number("cy_px");
}

Vehicle readVehicle(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  const YamlMap& y = yaml.root();
  Vehicle v;
  v.gravity_m_s2 = y.notNegative("gravity_m_s2");
  if (y.has("ins")) v.ins = readIns(y.map("ins"));
  if (y.has("dvl")) v.dvl = readDvl(y.map("dvl"));
  if (y.has("depth")) v.depth = readDepth(y.map("depth"));
  if (y.has("usbl")) v.usbl = readUsbl(y.map("usbl"));
  if (y.has("camera")) v.camera = readCamera(y.map("camera"));
  if (y.has("lamps"))
    for (const YamlMap& lamp : y.maps("lamps")) v.lamps.push_back(readLamp(lamp));
  yaml.rejectUnknownKeys();
  return v;
}

}  // namespace fathom
