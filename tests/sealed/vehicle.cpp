#include "vehicle.h"

#include <initializer_list>
#include <utility>

#include "core/text.h"

namespace fathom::sealed {
namespace {

using Entries = std::initializer_list<std::pair<const char*, double>>;

std::string lines(const Entries& entries) {
  std::string text;
  for (const auto& [key, value] : entries) text += std::string("  ") + key + ": " + shortest(value) + "\n";
  return text;
}

std::string yamlOf(const Mounting& m) {
  return "{x: " + shortest(m.x) + ", y: " + shortest(m.y) + ", z: " + shortest(m.z) +
         ", yaw_deg: " + shortest(m.yaw_deg) + ", pitch_deg: " + shortest(m.pitch_deg) +
         ", roll_deg: " + shortest(m.roll_deg) + "}";
}

std::string poseLine(const Mounting& mounting) { return "  pose: " + yamlOf(mounting) + "\n"; }

std::string yamlOf(const Ins& s) {
  return "ins:\n" +
         lines({{"rate_hz", s.rate_hz},
                {"gyro_sigma_rad_s", s.gyro_sigma_rad_s},
                {"accelerometer_sigma_m_s2", s.accelerometer_sigma_m_s2},
                {"gyro_bias_sigma_rad_s", s.gyro_bias_sigma_rad_s},
                {"accelerometer_bias_sigma_m_s2", s.accelerometer_bias_sigma_m_s2},
                {"bias_time_constant_s", s.bias_time_constant_s}}) +
         poseLine(s.pose);
}

std::string yamlOf(const Dvl& s) {
  std::string azimuths;
  for (const double azimuth : s.beam_azimuths_deg)
    azimuths += (azimuths.empty() ? "" : ", ") + shortest(azimuth);
  return "dvl:\n" +
         lines({{"rate_hz", s.rate_hz},
                {"assumed_sound_speed_m_s", s.assumed_sound_speed_m_s},
                {"beam_sigma_m_s", s.beam_sigma_m_s},
                {"velocity_sigma_xy_m_s", s.velocity_sigma_xy_m_s},
                {"velocity_sigma_z_m_s", s.velocity_sigma_z_m_s},
                {"range_sigma_m", s.range_sigma_m},
                {"beam_angle_deg", s.beam_angle_deg}}) +
         "  beam_azimuths_deg: [" + azimuths + "]\n" + poseLine(s.pose);
}

std::string yamlOf(const DepthGauge& s) {
  return "depth:\n" +
         lines({{"rate_hz", s.rate_hz},
                {"pressure_sigma_pa", s.pressure_sigma_pa},
                {"pressure_offset_sigma_pa", s.pressure_offset_sigma_pa},
                {"atmospheric_pressure_pa", s.atmospheric_pressure_pa},
                {"water_density_kg_m3", s.water_density_kg_m3}}) +
         poseLine(s.pose);
}

std::string yamlOf(const Camera& c) {
  return "camera:\n" +
         lines({{"rate_hz", c.rate_hz},
                {"width_px", c.width_px},
                {"height_px", c.height_px},
                {"fx_px", c.fx_px},
                {"fy_px", c.fy_px},
                {"cx_px", c.cx_px},
                {"cy_px", c.cy_px}}) +
         "  distortion: {k1: " + shortest(c.k1) + ", k2: " + shortest(c.k2) + ", p1: " + shortest(c.p1) +
         ", p2: " + shortest(c.p2) + ", k3: " + shortest(c.k3) + "}\n" +
         lines({{"exposure_s", c.exposure_s}}) + "  gain: fixed\n" +
         lines({{"response_gamma", c.response_gamma}}) + "  pipeline: linear\n" +
         lines({{"bits", 8},
                {"full_well_e", c.full_well_e},
                {"read_noise_e", c.read_noise_e},
                {"corner_sigma_px", c.corner_sigma_px}}) +
         poseLine(c.pose);
}

}  // namespace

std::string vehicleYaml(const Vehicle& vehicle) {
  std::string text = "gravity_m_s2: " + shortest(vehicle.gravity_m_s2) + "\n" + yamlOf(vehicle.ins) +
                     yamlOf(vehicle.dvl) + yamlOf(vehicle.depth) + yamlOf(vehicle.camera) + "lamps:\n";
  for (const Lamp& lamp : vehicle.lamps)
    text += std::string("  - {name: ") + lamp.name + ", half_angle_deg: " + shortest(lamp.half_angle_deg) +
            ", pose: " + yamlOf(lamp.pose) + "}\n";
  return text;
}

}  // namespace fathom::sealed
