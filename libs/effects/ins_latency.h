#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Ins;

struct InsLatency {
  template <class T>
  using Stage = ValidityOffset<T, Ins>;
  static constexpr std::string_view id = "ins-latency";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The INS's time stamp is not the time its readings were valid",
      .equation =
          "time of validity = time stamp - latency_s\n"
          "of gyro, accelerometer and attitude alike",
      .source = "Definition",
      .confused_with = {"dvl-latency", "camera-latency", "dvl-lever-arm"},
      .told_apart =
          "Turning at changing rates: against a camera or DVL only the difference of the latencies "
          "shows"};
  static constexpr std::array parameters{
      Parameter{.name = "latency_s",
                .unit = "s",
                .prior_sigma = 0.02,
                .limit = 5.0,
                .usual = "time stamp - true time, 0 to 0.1 s: filtering, serial line"}};
  template <class T>
  static void apply(const T* p, Stage<T>& offset) {
    offset.seconds -= p[0];
  }
};

}  // namespace fathom
