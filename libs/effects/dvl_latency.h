#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Dvl;

struct DvlLatency {
  template <class T>
  using Stage = ValidityOffset<T, Dvl>;
  static constexpr std::string_view id = "dvl-latency";
  static constexpr EffectText text{
      .channel = EffectChannel::navigation,
      .title = "The DVL's time stamp is not the time its readings were valid",
      .equation =
          "time of validity = time stamp - latency_s\n"
          "of the velocity and of the beams' ranges alike: one ping gives both",
      .source = "Definition",
      .confused_with = {"dvl-lever-arm", "ins-latency", "accelerometer-bias"},
      .told_apart = "Speeding up and turning, at changing rates; invisible at constant velocity"};
  static constexpr std::array parameters{
      Parameter{.name = "latency_s",
                .unit = "s",
                .prior_sigma = 0.1,
                .limit = 5.0,
                .usual = "time stamp - true time, 0 to 0.5 s: ping travel, averaging, serial line"}};
  template <class T>
  static void apply(const T* p, Stage<T>& offset) {
    offset.seconds -= p[0];
  }
};

}  // namespace fathom
