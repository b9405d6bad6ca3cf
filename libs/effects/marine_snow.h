#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct MarineSnow {
  template <class T>
  using Stage = SuspendedParticles<T>;
  static constexpr std::string_view id = "marine-snow";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "Flakes drift between the camera and the scene: specks in the image, others in each",
      .equation =
          "light = (1 - covered) light + covered flake, a flake's light being\n"
          "0.5 ambient exp(-a z) + veil (1 - exp(-a z)); covered: share of the pixel behind\n"
          "discs of 3 mm, z away, strewn by Poisson's law with density particles_per_m3",
      .source =
          "Alldredge & Silver 1988 (aggregates from half a millimetre to centimetres, some a litre of the "
          "smallest at the coast); of one size, flat and gray here",
      .confused_with = {"turbidity-plume", "separate-backscatter"},
      .told_apart =
          "A plain surface, black or white: flakes are specks on it, elsewhere in the next image, larger "
          "where nearer; all else changes the light of a surface smoothly"};
  static constexpr std::array parameters{
      Parameter{.name = "particles_per_m3",
                .unit = "1/m^3",
                .prior_sigma = 200,
                .limit = 10000,
                .positive = true,
                .usual = "as large as 3 mm: 10 to 1000; ten to a hundred times as many above 0.5 mm"}};
  template <class T>
  static void apply(const T* p, Stage<T>& particles) {
    particles.per_m3 += p[0];
  }
};

}  // namespace fathom
