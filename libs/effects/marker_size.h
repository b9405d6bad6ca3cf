#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct MarkerSize {
  template <class T>
  using Stage = MarkerPlacement<T>;
  static constexpr std::string_view id = "marker-size";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "All markers are larger, or smaller, than the panel map has them",
      .equation = "size_true = size (1 + scale_error), about each centre",
      .source = "Similarity: one marker alone gives range / size only",
      .confused_with = {"focal-scale", "dvl-scale", "flat-port-refraction"},
      .told_apart =
          "Two markers in one image: the distance of their centres does not scale; or another "
          "absolute scale"};
  static constexpr std::array parameters{
      Parameter{.name = "scale_error",
                .unit = "1",
                .prior_sigma = 0.01,
                .limit = 0.9,
                .usual = "true/nominal - 1, within 0.02; the border left out or counted in: 0.25"}};
  template <class T>
  static void apply(const T* p, Stage<T>& marker) {
    marker.size_m *= T(1.0) + p[0];
  }
};

}  // namespace fathom
