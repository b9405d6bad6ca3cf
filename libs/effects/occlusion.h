#pragma once

#include <array>
#include <cmath>

#include "core/scalar.h"
#include "effects/effect_text.h"
#include "effects/image_regions.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Occlusion {
  static constexpr double kUsualBrightness = 0.1;
  template <class T>
  using Stage = ViewCover<T>;
  static constexpr std::string_view id = "occlusion";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "Something is before a part of the view: a manipulator, a cable, dirt on the window",
      .equation =
          "light = (1 - covered) light + covered brightness, in the region of the image: one of nine, or a "
          "third of it",
      .source = "Definition: a mean over what is before a region, near the camera, where water adds nothing",
      .confused_with = {"flat-field", "vignetting", "illumination-gradient"},
      .told_apart =
          "Where in the image it is, whatever of the panel is seen there; and when, for what moves comes and "
          "goes"};
  static constexpr std::array parameters{
      Parameter{.name = "region",
                .unit = "1",
                .limit = static_cast<double>(kImageRegions.size()) - 1,
                .kind = ParameterKind::region,
                .usual = "upper left … lower right, upper third …"},
      Parameter{.name = "covered",
                .unit = "1",
                .prior_sigma = 0.3,
                .limit = 1,
                .positive = true,
                .usual = "share of the region, 0.05 to 0.5"},
      Parameter{.name = "brightness",
                .unit = "1",
                .prior_sigma = 1.0,
                .limit = 2,
                .kind = ParameterKind::shape,
                .at_zero = kUsualBrightness,
                .optional = true,
                .usual = "radiance of what is there, share of full scale: 0.02 to 0.5"}};
  template <class T>
  static void apply(const T* p, Stage<T>& view) {
    const auto region = static_cast<std::size_t>(std::lround(valueOf(p[0])));
    if (region >= kImageRegions.size()) return;
    using std::exp;
    view.share += kImageRegions[region].shareOf(view.place, view.spread) * p[1];
    view.radiance = kUsualBrightness * exp(p[2]);
  }
};

}  // namespace fathom
