#pragma once

#include <algorithm>
#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct ImageCompression {
  /// Of the first entry, a block's mean times 8, in the luminance table that the JPEG standard suggests.
  static constexpr double kStandardStep_dn = 16;

  template <class T>
  using Stage = ImageCoding<T>;
  static constexpr std::string_view id = "image-compression";
  static constexpr EffectText text{
      .channel = EffectChannel::image,
      .title = "Images were compressed as JPEG before they were recorded: blocks of 8 pixels show",
      .equation =
          "discrete cosine transform of each block of 8 x 8 pixels, rounded to multiples of table_scale "
          "times "
          "the standard table\n"
          "quality = 100 - 50 table_scale, where that is below 50: 50 / table_scale",
      .source = "ITU-T T.81, Annex K (tables); libjpeg's quality; Fan & de Queiroz 2003 (traces of blocks)",
      .confused_with = {"demosaicing", "defocus"},
      .told_apart =
          "Steps of brightness across the borders of blocks are larger than within them; nothing else knows "
          "where these borders are"};
  static constexpr std::array parameters{
      Parameter{.name = "table_scale",
                .unit = "1",
                .prior_sigma = 0.2,
                .limit = 10,
                .positive = true,
                .usual = "0.1 to 0.5, which are qualities of 95 to 75; images of 8 bits"}};
  static constexpr DerivedParameter derived{.name = "quality", .unit = "1", .size = 1};
  /// The quality, 1 to 100, by which libjpeg scales its tables so.
  static double qualityOf(double table_scale) {
    return std::clamp(table_scale > 1 ? 50 / table_scale : 100 - 50 * table_scale, 1.0, 100.0);
  }
  static Vector3d derive(const double* p, const DerivedFrom&) { return Vector3d::Constant(qualityOf(p[0])); }
  template <class T>
  static void apply(const T* p, Stage<T>& image) {
    image.quantum_dn += kStandardStep_dn * p[0];
  }
};

}  // namespace fathom
