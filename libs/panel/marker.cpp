#include "panel/marker.h"

namespace fathom {

std::array<Vector3d, 4> Marker::corners_panel() const {
  std::array<Vector3d, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto [right, up] = kMarkerCorners[k];
    corners[k] = T_panel_marker * Vector3d(Vector3d(right * size_m / 2, up * size_m / 2, 0) +
                                           off_square_m.col(static_cast<Eigen::Index>(k)));
  }
  return corners;
}

bool isBrightSquare(const std::string& family, const MarkerLook& look) {
  return hasPlainBorder(family) == look.white_on_black;
}

std::string nameOf(const Marker& marker) { return marker.family + " " + std::to_string(marker.id); }

}  // namespace fathom
