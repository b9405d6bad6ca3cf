#pragma once

#include <array>
#include <cmath>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/peak.h"
#include "effects/stages.h"

namespace fathom {

struct TurbidityPlume {
  template <class T>
  using Stage = WaterRay<T>;
  static constexpr std::string_view id = "turbidity-plume";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "A cloud of sediment passes: for a while the water is more turbid",
      .equation =
          "a(t) = a + peak_extra_attenuation_per_m exp(-((t - time_s) / width)^2 / 2), of signal and veil,\n"
          "of each colour; width = 10 s exp(log_width)\n"
          "a cloud in space, of size 1 / |k| along and across: (t - time_s) / width becomes\n"
          "(t - time_s) / width - k . x, and across that |k| x - middle, horizontal and up; x from the map's "
          "first\n"
          "panel, odom; k = per_m, 0 for water that is everywhere alike; a is then integrated along the line "
          "of sight",
      .source =
          "A puff that diffuses while a current carries it past has a Gaussian concentration, e.g. Fischer "
          "et al. 1979; attenuation goes with concentration",
      .confused_with = {"auto-exposure", "sun-flicker", "slant-range", "separate-backscatter"},
      .told_apart =
          "White and black near and far while it lasts: a plume takes more from what is farther away and "
          "brightens black, a gain takes the same share of all"};
  static constexpr std::array parameters{
      Parameter{.name = "peak_extra_attenuation_per_m",
                .unit = "1/m",
                .prior_sigma = 0.3,
                .limit = 10,
                .positive = true,
                .usual = "above the water's own attenuation, 0.05 to 1"},
      Parameter{.name = "time_s",
                .unit = "s",
                .prior_sigma = 1000,
                .limit = 1e9,
                .kind = ParameterKind::peak_time,
                .usual = "of the peak, since the recording's first entry"},
      Parameter{.name = "log_width",
                .unit = "1",
                .prior_sigma = 0.7,
                .limit = 5,
                .kind = ParameterKind::log_width,
                .optional = true,
                .usual = "0: its standard deviation is 10 s; 1: 27 s; -1: 4 s",
                .usual_width_s = 10},
      Parameter{
          .name = "per_m",
          .unit = "1/m",
          .size = 2,
          .prior_sigma = 0.7,
          .limit = 100,
          .optional = true,
          .usual = "1 over its size, along which way it drifts (odom): clouds of 0.5 m to many; 0: no end"},
      Parameter{.name = "middle",
                .unit = "1",
                .size = 2,
                .prior_sigma = 1,
                .limit = 100,
                .optional = true,
                .usual =
                    "how far off the panel its middle passes, horizontally across its way and upwards, in "
                    "sizes: within 1"}};
  template <class T>
  static void apply(const T* p, Stage<T>& ray) {
    using std::exp, std::sqrt;
    constexpr double kEndless_per_m2 = 1e-12;  // whose root still has a derivative
    const T width_s = parameters[2].usual_width_s * exp(p[2]);
    const T size_per_m = sqrt(p[3] * p[3] + p[4] * p[4] + kEndless_per_m2);
    // In sizes: along its way, across it, upwards.
    const auto inSizes = [&](const Vector3<T>& way) {
      return Vector3<T>(p[3] * way.x() + p[4] * way.y(), p[3] * way.y() - p[4] * way.x(),
                        size_per_m * way.z());
    };
    const Vector3<T> camera =
        inSizes(ray.sight.camera_m) - Vector3<T>((ray.t_s - p[1]) / width_s, p[5], p[6]);
    const T extra = p[0] * ray.z_m * meanOfGaussian<T>(camera, inSizes(ray.sight.direction * ray.range_m));
    for (int c = 0; c < 3; ++c) {
      ray.signal_depth[c] += extra;
      ray.veil_depth[c] += extra;
    }
  }
};

}  // namespace fathom
