#include "sensors/vehicle.h"

#include <cmath>

#include "core/error.h"
#include "core/yaml.h"
#include "effects/catalogue.h"

namespace fathom {
namespace {

/// Fills a specification from its section, see its fields().
class ReadFields {
 public:
  explicit ReadFields(const YamlMap& y) : y_(y) {}

  void positive(const char* key, double& value) const { value = y_.positive(key); }
  void notNegative(const char* key, double& value) const { value = y_.notNegative(key); }
  void numberWithin(const char* key, double& value, double limit) const {
    value = y_.number(key);
    if (std::abs(value) > limit)
      throw y_.error(key, "must be within +-" + std::to_string(std::lround(limit)));
  }
  void degrees(const char* key, double& value_rad) const { value_rad = radians(y_.number(key)); }
  void positiveDegrees(const char* key, double& value_rad) const { value_rad = radians(y_.positive(key)); }
  void degreesBelow(const char* key, double& value_rad, double limit_deg) const {
    value_rad = radians(y_.positive(key));
    if (value_rad >= radians(limit_deg))
      throw y_.error(key, "must be below " + std::to_string(std::lround(limit_deg)));
  }
  /// One for all axes, or [roll, pitch, heading].
  void optionalAngles(const char* key, std::optional<AttitudeSigma>& sigma) const {
    if (!y_.has(key)) return;
    if (!y_.isList(key)) {
      sigma = radians(y_.positive(key));
      return;
    }
    const Vector3d axes = y_.vector3(key);
    if (axes.minCoeff() <= 0.0) throw y_.error(key, "must be greater than zero");
    sigma.emplace(radians(axes.x()), radians(axes.y()), radians(axes.z()));
  }
  void listOfDegrees(const char* key, std::vector<double>& values_rad) const {
    values_rad.clear();
    for (const double value_deg : y_.numbers(key)) values_rad.push_back(radians(value_deg));
  }
  void pose(const char* key, Pose& pose) const { pose = y_.pose(key); }

 private:
  const YamlMap& y_;
};

Window readWindow(const YamlMap& y) {
  const Window window{y.notNegative("distance_m"), radians(y.number("tilt_deg")),
                      radians(y.number("tilt_y_deg"))};
  if (std::hypot(window.tilt_x_rad, window.tilt_y_rad) > radians(80))
    throw y.error("tilt_deg", "the window must be before the camera");
  return window;
}

CameraPipeline readPipeline(const YamlMap& y) {
  const std::string text = y.text("pipeline");
  if (text == "linear") return CameraPipeline::linear;
  if (text == "raw") return CameraPipeline::raw;
  if (text == "processed") return CameraPipeline::processed;
  throw y.error("pipeline", "must be linear, raw or processed");
}

BayerPattern readBayer(const YamlMap& y) {
  const auto pattern = bayerNamed(y.text("bayer"));
  if (!pattern) throw y.error("bayer", "must be rggb, grbg, gbrg or bggr");
  return *pattern;
}

CameraSheet readCamera(const YamlMap& y) {
  CameraSheet s;
  s.rate_hz = y.positive("rate_hz");
  s.model.width_px = y.integer("width_px");
  s.model.height_px = y.integer("height_px");
  if (s.model.width_px <= 0 || s.model.height_px <= 0)
    throw y.error("width_px", "image size must be greater than zero");
  readPinhole(y, s.model);
  readDistortion(y.map("distortion"), s.model);
  s.exposure_s = y.positive("exposure_s");
  s.gain = y.text("gain");
  if (s.gain != "fixed" && s.gain != "auto") throw y.error("gain", "must be fixed or auto");
  s.response_gamma = y.positive("response_gamma");
  if (y.has("pipeline")) s.pipeline = readPipeline(y);
  if (s.pipeline == CameraPipeline::raw) s.model.bayer = readBayer(y);
  s.bits = y.integer("bits");
  if (s.bits < 1 || s.bits > 16) throw y.error("bits", "must be from 1 to 16");
  s.full_well_e = y.positive("full_well_e");
  s.read_noise_e = y.notNegative("read_noise_e");
  s.corner_sigma_px = y.positive("corner_sigma_px");
  s.T_robot_camera = y.pose("pose");
  if (y.has("window")) s.model.window = readWindow(y.map("window"));
  y.read("above_water", s.model.above_water);
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

LimitsSheet readLimits(const YamlMap& y) {
  LimitsSheet s;
  if (y.has("speed_m_s")) s.speed_m_s = y.positive("speed_m_s");
  if (y.has("turn_rate_deg_s")) s.turn_rate_rad_s = radians(y.positive("turn_rate_deg_s"));
  if (y.has("depth_m")) s.depth_m = y.positive("depth_m");
  return s;
}

bool isSectionOfSensor(const std::string& section) {
  bool is_one = section == "camera";
  forEachInstrument([&]<class Instrument>() { is_one = is_one || section == Instrument::section; });
  return is_one;
}

/// One section for each kind, behind its name the instance's.
void readSensors(const YamlMap& y, const Instance& instance, SensorsOnBoard& sensors) {
  forEachInstrument([&]<class Instrument>() {
    const std::string section = instance.label(Instrument::section);
    if (!y.has(section) || sensors.*Instrument::on_board) return;  // one section may be of two instruments
    typename Instrument::Sheet sheet;
    sheet.fields(ReadFields(y.map(section)));
    sensors.*Instrument::on_board = sheet;
  });
  if (const std::string section = instance.label("camera"); y.has(section))
    sensors.camera = readCamera(y.map(section));
}

}  // namespace

const SensorsOnBoard& Vehicle::sensors(const Instance& instance) const {
  static const SensorsOnBoard none;
  if (instance.isFirst()) return *this;
  const auto found = others.find(instance);
  return found == others.end() ? none : found->second;
}

void requireInstances(const EffectParameters<double>& effects, const Vehicle& vehicle,
                      const std::string& calibration) {
  const auto require = [&](std::size_t effect, const Instance& instance) {
    if (instance.isFirst() || vehicle.others.contains(instance)) return;
    std::string there = std::string(Instance::kFirst);
    for (const auto& [other, sensors] : vehicle.others) there.append(", ").append(other.name());
    throw Error(calibration, std::string(allEffects()[effect].id),
                "the vehicle has no instance " + std::string(instance.name()) + "; there are " + there);
  };
  for (std::size_t e = 0; e < kEffectCount; ++e)
    if (effects.on[e] && effects.only[e]) require(e, *effects.only[e]);
  for (const auto& f : effects.further) require(f.effect, f.instance);
}

void readPinhole(const YamlMap& y, CameraModel& camera) {
  camera.fx_px = y.positive("fx_px");
  camera.fy_px = y.positive("fy_px");
  camera.cx_px = y.number("cx_px");
  camera.cy_px = y.number("cy_px");
}

void readDistortion(const YamlMap& y, CameraModel& camera) {
  if (y.has("model")) {
    const auto lens = lensNamed(y.text("model"));
    if (!lens) throw y.error("model", "must be plumb_bob, rational or fisheye");
    camera.lens = *lens;
  }
  for (const LensCoefficient& c : coefficientsOf(camera.lens)) camera.*c.value = y.number(c.name);
}

Vehicle readVehicle(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  const YamlMap& y = yaml.root();
  Vehicle v;
  v.gravity_m_s2 = y.notNegative("gravity_m_s2");
  readSensors(y, {}, v);
  for (const std::string& section : y.keys()) {
    if (const auto instance = Instance::of(section, baseOf(section)); instance && !instance->isFirst()) {
      if (!v.others.contains(*instance)) readSensors(y, *instance, v.others[*instance]);
    } else if (isSectionOfSensor(section.substr(0, section.find('.'))) &&
               section.find('.') != std::string::npos) {
      throw y.error(section, "behind the dot must be 1 to 15 letters, digits, `_` or `-`, and not `first`");
    }
  }
  if (y.has("limits")) v.limits = readLimits(y.map("limits"));
  if (y.has("lamps"))
    for (const YamlMap& lamp : y.maps("lamps")) v.lamps.push_back(readLamp(lamp));
  yaml.rejectUnknownKeys();
  return v;
}

}  // namespace fathom
