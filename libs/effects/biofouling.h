#pragma once

#include <array>
#include <cmath>

#include "core/scalar.h"
#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct Biofouling {
  static constexpr double kUsualAlbedo = 0.08;
  template <class T>
  using Stage = MarkerCover<T>;
  static constexpr std::string_view id = "biofouling";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "Something grows on one marker: its white is darker, its black hardly",
      .equation =
          "albedo_true = (1 - covered) albedo + covered growth_albedo, of the marker's white and black cells",
      .source =
          "Area mixture; benthic algae and turf reflect 0.03 to 0.15 in red to blue (Hochberg, Atkinson & "
          "Andrefouet 2003)",
      .confused_with = {"illumination-gradient", "turbidity-plume", "auto-exposure"},
      .told_apart =
          "Its neighbours in the same images: it shows on one id, near and far by the same share, and on "
          "white far more than on black"};
  static constexpr std::array parameters{
      Parameter{.name = "marker_id",
                .unit = "1",
                .limit = 1e6,
                .kind = ParameterKind::marker_id,
                .usual = "one of the panel map's"},
      Parameter{.name = "covered",
                .unit = "1",
                .prior_sigma = 0.2,
                .limit = 1,
                .positive = true,
                .usual = "share of the marker's area; a marker is found up to about 0.5"},
      Parameter{.name = "growth_albedo",
                .unit = "1",
                .size = 3,
                .prior_sigma = 0.5,
                .limit = 1,
                .kind = ParameterKind::shape,
                .at_zero = kUsualAlbedo,
                .optional = true,
                .usual = "of what grows there, red green blue, 0.03 to 0.2; known to a factor of 1.6"}};
  template <class T>
  static void apply(const T* p, Stage<T>& marker) {
    if (static_cast<int>(std::lround(valueOf(p[0]))) != marker.id) return;
    using std::exp;
    marker.share += p[1];
    for (int c = 0; c < 3; ++c) marker.albedo[c] = kUsualAlbedo * exp(p[2 + c]);
  }
};

}  // namespace fathom
