#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Camera;

struct CameraLatency {
  template <class T>
  using Stage = ValidityOffset<T, Camera>;
  static constexpr std::string_view id = "camera-latency";
  static constexpr EffectText text{.channel = EffectChannel::marker_geometry,
                                   .title = "The image's time stamp is not the time it was taken",
                                   .equation = "time of validity = time stamp - latency_s",
                                   .source = "Furgale et al. 2013 (temporal calibration)",
                                   .confused_with = {"rolling-shutter", "ins-latency", "dvl-latency"},
                                   .told_apart = "Turning and moving at changing rates, both ways"};
  static constexpr std::array parameters{
      Parameter{.name = "latency_s",
                .unit = "s",
                .prior_sigma = 0.05,
                .limit = 5.0,
                .usual = "time stamp - true time, 0 to 0.2 s: exposure, transfer, encoding"}};
  template <class T>
  static void apply(const T* p, Stage<T>& offset) {
    offset.seconds -= p[0];
  }
};

}  // namespace fathom
