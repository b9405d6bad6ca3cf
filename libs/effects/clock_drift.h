#pragma once

#include <array>
#include <cmath>

#include "core/scalar.h"
#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/sensor_kinds.h"
#include "effects/stages.h"

namespace fathom {

struct ClockDrift {
  template <class T>
  using Stage = Validity<T>;
  static constexpr std::string_view id = "clock-drift";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "One sensor's clock runs fast or slow",
      .equation =
          "time stamp = true time (1 + 1e-6 rate_ppm), so time of validity = time stamp / (1 + 1e-6 "
          "rate_ppm)\n"
          "times since the recording's first entry, when all clocks agree; only clocks that differ show it: "
          "one for "
          "all sensors changes no more than the unit of time",
      .source =
          "Quartz oscillators: 10 to 100 ppm by their data sheets, more where temperatures change; Mills "
          "2010 "
          "(Computer Network Time Synchronization)",
      .confused_with = {"ins-latency", "dvl-latency", "camera-latency"},
      .told_apart =
          "A long recording that turns and moves at changing rates at both ends: a latency is as large at "
          "the "
          "beginning, a drift grows from nothing"};
  static constexpr std::array parameters{
      Parameter{.name = "sensor",
                .unit = "1",
                .limit = static_cast<double>(kSensorKinds.size()) - 1,
                .kind = ParameterKind::sensor,
                .usual = "INS, DVL, DEPTH, CAMERA, ...: whose clock, by the label of its entries"},
      Parameter{.name = "rate_ppm",
                .unit = "ppm",
                .prior_sigma = 50.0,
                .limit = 1e4,
                .usual = "positive where it runs fast, 1 to 100: 0.2 s an hour at 50"}};
  template <class T>
  static void apply(const T* p, Stage<T>& offset) {
    if (static_cast<int>(std::lround(valueOf(p[0]))) != offset.sensor) return;
    const T rate = 1e-6 * p[1];
    offset.seconds -= offset.t_s * rate / (1.0 + rate);
  }
};

}  // namespace fathom
