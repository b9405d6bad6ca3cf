#include "imaging/image_texture.h"

#include "effects/image_compression.h"

namespace fathom {

const BlockTransform& BlockTransform::instance() {
  static const BlockTransform transform;
  return transform;
}

BlockTransform::BlockTransform() {
  Table waves;  // a row each
  for (int u = 0; u < kSide; ++u)
    for (int x = 0; x < kSide; ++x)
      waves(u, x) = std::sqrt((u == 0 ? 1.0 : 2.0) / kSide) *
                    std::cos((2 * x + 1) * u * std::numbers::pi / (2 * kSide));
  at_border = waves.col(0);
  of_step = (waves.rightCols<kSide - 1>() - waves.leftCols<kSide - 1>()).square().rowwise().mean();
  const Axis place = Axis::LinSpaced(kSide, 0, kSide - 1) - 0.5 * (kSide - 1);
  of_slope = std::sqrt(static_cast<double>(kSide)) * (waves.matrix() * place.matrix()).array();
  // ITU-T T.81, table K.1.
  steps << 16, 11, 10, 16, 24, 40, 51, 61,  //
      12, 12, 14, 19, 26, 58, 60, 55,       //
      14, 13, 16, 24, 40, 57, 69, 56,       //
      14, 17, 22, 29, 51, 87, 80, 62,       //
      18, 22, 37, 56, 68, 109, 103, 77,     //
      24, 35, 55, 64, 81, 104, 113, 92,     //
      49, 64, 78, 87, 103, 121, 120, 101,   //
      72, 92, 95, 98, 112, 100, 103, 99;
  // Steps are looked at to the side and downwards alike.
  steps = (0.5 / ImageCompression::kStandardStep_dn * (steps + steps.transpose())).eval();
}

std::optional<int> codingQuality(const ImageCoding<double>& coding) {
  if (coding.quantum_dn <= 0) return std::nullopt;
  return static_cast<int>(
      std::lround(ImageCompression::qualityOf(coding.quantum_dn / ImageCompression::kStandardStep_dn)));
}

}  // namespace fathom
