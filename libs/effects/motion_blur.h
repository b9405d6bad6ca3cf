#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct MotionBlur {
  template <class T>
  using Stage = ExposureTime<T>;
  static constexpr std::string_view id = "motion-blur";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title =
          "The shutter is open for longer than the vehicle file states: what moves is smeared along its way",
      .equation =
          "light = mean of the light along w exposure_s, w the pixel's velocity; an edge's\n"
          "blur, a covariance, is w w^T exposure_s^2 / 12, exposure_s instead of the\n"
          "vehicle file's",
      .source =
          "Potmesil & Chakravarty 1983, modeling motion blur: an image is the mean over the time for which "
          "the shutter is open; a uniform distribution's variance is its width's square by 12",
      .confused_with = {"forward-scatter"},
      .told_apart =
          "Moving sideways and up and down, fast and slowly: only motion smears along its own way, and with "
          "the square of the speed"};
  static constexpr std::array parameters{
      Parameter{.name = "exposure_s",
                .unit = "s",
                .prior_sigma = 4e-4,
                .limit = 1,
                .positive = true,
                .squared = true,
                .usual = "time for which the shutter is open: 0.002 to 0.1"}};
  template <class T>
  static void apply(const T* p, Stage<T>& exposure) {
    exposure.squared_s2 += p[0];
  }
};

}  // namespace fathom
