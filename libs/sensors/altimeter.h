#pragma once

#include <algorithm>
#include <optional>
#include <tuple>
#include <vector>

#include "sensors/instrument.h"

namespace fathom {

/// Section `altimeter` of the vehicle file.
struct AltimeterSheet {
  double rate_hz = 10;
  double range_sigma_m = 0.02;  ///< white, each sample
  Pose T_robot_altimeter;       ///< x along the beam

  template <class Fields>
  void fields(Fields&& f) {
    f.positive("rate_hz", rate_hz);
    f.positive("range_sigma_m", range_sigma_m);
    f.pose("pose", T_robot_altimeter);
  }
};

/// An entry ALTIMETER.
struct AltimeterSample {
  Pose T_robot_altimeter;
  std::optional<double> range_m;  ///< absent: no echo (stored as 0)
};

/// An echo sounder that looks at the flat sea floor, whose height is estimated along.
struct Altimeter {
  static constexpr const char* label = "ALTIMETER";
  static constexpr std::string_view section = "altimeter", kind = "altimeter";
  using Instrument = Altimeter;
  using Sheet = AltimeterSheet;
  using Sample = AltimeterSample;
  struct OnBoard {
    std::optional<AltimeterSheet> altimeter;
  };
  static constexpr auto on_board = &OnBoard::altimeter;

  static constexpr std::array values{ValueText{.name = "range",
                                               .unit = "m",
                                               .kind = ValueText::Kind::scalar,
                                               .absent = "echo",
                                               .fault = "altimeter_m",
                                               .lowest = 0,
                                               .highest = 12'000,  // the deepest sea
                                               .wild_low = 0,
                                               .wild_high = 50,
                                               .least = 1e-3}};
  template <class Entry, class F>
  static void forEachValue(Entry& s, F&& f) {
    f(0, s.range_m ? &*s.range_m : nullptr);
  }
  static std::vector<Pose> mountings(const AltimeterSample& s) { return {s.T_robot_altimeter}; }
  static std::vector<Pose> mountings(const AltimeterSheet& s) { return {s.T_robot_altimeter}; }

  class Simulated;

  using Channels = std::tuple<Altimeter>;
  static constexpr ChannelText channel{.id = "altimeter",
                                       .label = label,
                                       .unit = "mm",
                                       .scale = 1000,
                                       .metric = "altimeter_rms_mm",
                                       .material = 0.01,
                                       .component_count = 1,
                                       .has_outliers = true,
                                       .start = ChannelText::Start::sea_floor,
                                       .is_indirect = true};
  static constexpr const char* lacking = "ALTIMETER without an echo";
  template <class F>
  static void observe(const AltimeterSample& s, const AltimeterSheet& sheet, F&& f) {
    if (s.range_m) f(Observation::scalar(*s.range_m, sheet.range_sigma_m, s.T_robot_altimeter));
  }
  template <class T>
  static Vector1<T> predict(const Inputs<T>& in, const AltimeterSheet&, const Observation& seen) {
    const auto mount = in.template mounting<Altimeter>(seen.T_robot_sensor);
    return Vector1<T>(rangeToFloor<T>(in, mount.position_robot, mount.R_robot_sensor.col(0)));
  }
};

class Altimeter::Simulated {
 public:
  static constexpr std::uint64_t kFirstStream = 9, kStreams = 1;
  Simulated(const AltimeterSheet& sheet, const SimulatedNoise& noise)
      : sheet_(sheet), noise_(noise), random_(noise.stream(kFirstStream)) {}

  AltimeterSample read(const Inputs<double>* in) {
    const double error_m = noise_.sigma(sheet_.range_sigma_m) * random_.normal();
    AltimeterSample sample{sheet_.T_robot_altimeter, {}};
    if (in == nullptr) return sample;
    const double range_m = predict(*in, sheet_, {{}, {}, sheet_.T_robot_altimeter})[0];
    if (range_m >= noise_.beam_min_range_m && range_m <= noise_.beam_max_range_m)
      sample.range_m = std::max(range_m + error_m, values[0].least);
    return sample;
  }

 private:
  const AltimeterSheet& sheet_;
  SimulatedNoise noise_;
  Random random_;
};

}  // namespace fathom
