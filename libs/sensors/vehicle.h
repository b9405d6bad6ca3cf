#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/geometry.h"
#include "core/instance.h"
#include "sensors/all_instruments.h"

/// The vehicle file: what an engineer knows of the robot from data sheets and drawings. See config/rov.yaml.
namespace fathom {

class YamlMap;

/// What a camera's images are: numbers that go with the light by the response stated; the same as its sensor
/// measures them, of one colour each (one channel, `bayer`: rggb, grbg, gbrg or bggr); or processed by a
/// curve that nobody states, with colours weighed anew for each image, sharpened, compressed.
enum class CameraPipeline { linear, raw, processed };

struct CameraSheet {
  double rate_hz = 1;
  CameraModel model;
  double exposure_s = 0.004;
  std::string gain = "fixed";
  double response_gamma = 1.0;
  CameraPipeline pipeline = CameraPipeline::processed;  ///< optional key
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
  /// Optional key `above_water: true`, which is model.above_water: the camera (of a pair, both) is in air and
  /// looks down through the water's surface. Without it the effect flat-water-surface does nothing.
  ///
  /// Optional key `right_window`, as `window` of the left one, which is model.window: {distance_m, tilt_deg,
  /// tilt_y_deg}.
  Window right_window;
};

struct LampSheet {
  std::string name;
  double half_angle_rad = 0;
  Pose T_robot_lamp;  ///< light leaves along x
};

/// Section `limits`, and each of its keys, may be left out: what such a vehicle does not exceed.
struct LimitsSheet {
  double speed_m_s = 10;
  double turn_rate_rad_s = radians(180);
  double depth_m = 6000;
};

/// What instruments of a list there are on board, each under its own name: `ins`, `dvl`, …
template <class Instruments>
struct OnBoardOf;
template <class... Instruments>
struct OnBoardOf<std::tuple<Instruments...>> : Instruments::OnBoard... {};

/// A sensor whose section is absent is not on board.
struct SensorsOnBoard : OnBoardOf<AllInstruments> {
  std::optional<CameraSheet> camera;
};

/// Its own are the first of each kind; sections `dvl.2`, `camera.port` are others'.
struct Vehicle : SensorsOnBoard {
  double gravity_m_s2 = 9.80665;
  LimitsSheet limits;
  std::vector<LampSheet> lamps;
  std::map<Instance, SensorsOnBoard> others;

  /// Those of one instance, of each kind; none where there is no such instance.
  const SensorsOnBoard& sensors(const Instance& instance) const;
  /// Calls f(instance, its sensors) for all, the first before others.
  template <class F>
  void forEachInstance(F&& f) const {
    f(Instance(), static_cast<const SensorsOnBoard&>(*this));
    for (const auto& [instance, sensors] : others) f(instance, sensors);
  }

  Vector3d gravityOdom() const { return {0, 0, -gravity_m_s2}; }
};

/// An instrument's or a channel's part of the vehicle file; the defaults where there is none.
template <class C>
const auto& sheetOf(const Vehicle& vehicle, const Instance& instance = {}) {
  using Sheet = typename C::Instrument::Sheet;
  static const Sheet defaults = [] {
    Sheet sheet;
    if constexpr (requires { sheet.is_absent; }) sheet.is_absent = true;
    return sheet;
  }();
  const std::optional<Sheet>& sheet = vehicle.sensors(instance).*C::Instrument::on_board;
  return sheet ? *sheet : defaults;
}

/// Of the first camera; linear where there is none.
inline CameraPipeline pipelineOf(const Vehicle& vehicle) {
  return vehicle.camera ? vehicle.camera->pipeline : CameraPipeline::linear;
}

/// Whether any camera is on board.
inline bool hasCamera(const Vehicle& vehicle) {
  bool any = false;
  vehicle.forEachInstance(
      [&](const Instance&, const SensorsOnBoard& s) { any = any || s.camera.has_value(); });
  return any;
}

/// Throws Error, about the calibration, where an effect is of an instance that the vehicle has nothing of.
void requireInstances(const EffectParameters<double>& effects, const Vehicle& vehicle,
                      const std::string& calibration);

/// Strict, see core/yaml.h. Throws Error.
Vehicle readVehicle(const std::filesystem::path& file);

/// A camera's fx_px, fy_px, cx_px, cy_px, wherever they stand. Throws Error.
void readPinhole(const YamlMap& y, CameraModel& camera);
/// A lens's coefficients by name; `model`, where it is not plumb_bob. Throws Error.
void readDistortion(const YamlMap& y, CameraModel& camera);

}  // namespace fathom
