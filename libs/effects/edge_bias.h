#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct EdgeBias {
  template <class T>
  using Stage = EdgeSpread<T>;
  static constexpr std::string_view id = "edge-bias";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "White grows over black in images: edges are not where the surfaces have them",
      .equation =
          "each edge moves by offset_px toward its dark side: all sides of a black square inward, its "
          "corners "
          "along "
          "both sides' normals, those of a white one outward; however far away the marker is",
      .source =
          "Definition; light that spills into neighbouring pixels, clipped highlights, sharpening and "
          "thresholds do it. A printer's dot gain (Yule & Nielsen 1951) does the reverse in metres",
      .confused_with = {"marker-size", "gamma", "focal-scale"},
      .told_apart =
          "Markers near and far: so many pixels at any range, where a wrong size is the same share of the "
          "marker; gamma changes patches too"};
  static constexpr std::array parameters{Parameter{.name = "offset_px",
                                                   .unit = "px",
                                                   .prior_sigma = 0.05,
                                                   .limit = 2.0,
                                                   .usual = "positive where white grows, within 0.2"}};
  template <class T>
  static void apply(const T* p, Stage<T>& edges) {
    edges.white_px += p[0];
  }
};

}  // namespace fathom
