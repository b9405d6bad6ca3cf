#pragma once

#include <limits>
#include <optional>
#include <tuple>
#include <vector>

#include "sensors/instrument.h"

namespace fathom {

/// Section `depth` of the vehicle file.
struct DepthSheet {
  double rate_hz = 5;
  double pressure_sigma_pa = 100;
  double pressure_offset_sigma_pa = 100;
  double atmospheric_pressure_pa = 101325;
  double water_density_kg_m3 = 1025;
  Pose T_robot_depth;

  template <class Fields>
  void fields(Fields&& f) {
    f.positive("rate_hz", rate_hz);
    f.positive("pressure_sigma_pa", pressure_sigma_pa);
    f.notNegative("pressure_offset_sigma_pa", pressure_offset_sigma_pa);
    f.positive("atmospheric_pressure_pa", atmospheric_pressure_pa);
    f.positive("water_density_kg_m3", water_density_kg_m3);
    f.pose("pose", T_robot_depth);
  }
};

/// An entry DEPTH.
struct DepthSample {
  Pose T_robot_depth;
  double pressure_pa = 0.0;  ///< absolute
  std::optional<double> temperature_celsius;
};

/// The pressure sensor: absolute pressure p = p_air - rho g z, with odom's z = 0 at the surface
/// (hydrostatics, constant density).
struct Depth {
  static constexpr const char* label = "DEPTH";
  static constexpr std::string_view section = "depth", kind = "depth";
  using Sheet = DepthSheet;
  using Sample = DepthSample;
  struct OnBoard {
    std::optional<DepthSheet> depth;
  };
  static constexpr auto on_board = &OnBoard::depth;

  static constexpr std::array values{ValueText{.name = "pressure",
                                               .unit = "pa",
                                               .kind = ValueText::Kind::scalar,
                                               .fault = "pressure_pa",
                                               .lowest = 0,
                                               .highest = 1.3e8,  // at the bottom of the deepest sea
                                               .wild_low = 0,
                                               .wild_high = 1.1e6},  // 100 m of water
                                     ValueText{.name = "temperature",
                                               .unit = "celsius",
                                               .kind = ValueText::Kind::scalar,
                                               .absent = "temperature"}};
  template <class Entry, class F>
  static void forEachValue(Entry& s, F&& f) {
    f(0, &s.pressure_pa);
    f(1, s.temperature_celsius ? &*s.temperature_celsius : nullptr);
  }
  static std::vector<Pose> mountings(const DepthSample& s) { return {s.T_robot_depth}; }
  static std::vector<Pose> mountings(const DepthSheet& s) { return {s.T_robot_depth}; }

  class Simulated;

  using Channels = std::tuple<Depth>;
  using Instrument = Depth;
  static constexpr ChannelText channel{.id = "depth",
                                       .label = label,
                                       .unit = "mm of water",
                                       .scale = 1000 / 9806.65,
                                       .metric = "depth_rms_mm",
                                       .material = 50,  // 5 mm
                                       .component_count = 1,
                                       .start = ChannelText::Start::height};
  using DriftEffect = PressureOffset;
  static Drift drift(const DepthSheet& s) {
    return {.sigma = s.pressure_offset_sigma_pa, .rate_hz = s.rate_hz};
  }
  template <class F>
  static void observe(const DepthSample& s, const DepthSheet& sheet, F&& f) {
    f(Observation::scalar(s.pressure_pa, sheet.pressure_sigma_pa, s.T_robot_depth));
  }
  template <class T>
  static Vector1<T> predict(const Inputs<T>& in, const DepthSheet& sheet, const Observation& seen) {
    return Vector1<T>(pressure(in, sheet, seen.T_robot_sensor));
  }
  /// Pa.
  template <class T>
  static T pressure(const Inputs<T>& in, const DepthSheet& sheet, const Pose& T_robot_depth) {
    const auto mount = in.template mounting<Depth>(T_robot_depth);
    const T z = in.state.position_odom.z() + in.state.R_odom_robot.row(2).dot(mount.position_robot);
    const SeaWater<T> water = in.at(SeaWater<T>{T(sheet.water_density_kg_m3)});
    const T weight_n_m3 = water.density_kg_m3 * -in.world.gravity_odom.z();
    return in.at(PressureReading<T>{T(sheet.atmospheric_pressure_pa) - weight_n_m3 * z}).pressure_pa;
  }
};

/// White noise, and one random offset a run, which enters through the effect pressure-offset.
class Depth::Simulated {
 public:
  static constexpr std::uint64_t kFirstStream = 5, kStreams = 1;
  Simulated(const DepthSheet& sheet, const SimulatedNoise& noise)
      : sheet_(sheet), noise_(noise), random_(noise.stream(kFirstStream)) {
    offset_pa_ = noise.sigma(sheet.pressure_offset_sigma_pa) * random_.normal();
  }

  void draw(EffectParameters<double>& effects) const {
    if (noise_.on) effects.add<PressureOffset>({offset_pa_});
  }
  DepthSample read(const Inputs<double>* in) {
    const double error_pa = noise_.sigma(sheet_.pressure_sigma_pa) * random_.normal();
    DepthSample sample{sheet_.T_robot_depth, std::numeric_limits<double>::quiet_NaN(), {}};
    if (in != nullptr) sample.pressure_pa = pressure(*in, sheet_, sheet_.T_robot_depth) + error_pa;
    return sample;
  }

 private:
  const DepthSheet& sheet_;
  SimulatedNoise noise_;
  Random random_;
  double offset_pa_;
};

}  // namespace fathom
