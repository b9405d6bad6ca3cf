#pragma once

#include <array>
#include <string_view>

#include "core/camera_model.h"

namespace fathom {

/// A part of an image: shares of its width and height, from the left and from above.
struct ImageRegion {
  std::string_view name;
  double left = 0, right = 1, top = 0, bottom = 1;

  bool contains(const Vector2d& place) const {
    return place.x() >= left && place.x() < right && place.y() >= top && place.y() < bottom;
  }
};

/// What a parameter of ParameterKind::region names, by its place in this list: nine that an image consists
/// of, then its thirds.
inline constexpr std::size_t kImageCells = 9;
inline constexpr double kThird = 1.0 / 3;
inline constexpr std::array<ImageRegion, 15> kImageRegions{
    {{"upper left", 0, kThird, 0, kThird},
     {"upper middle", kThird, 2 * kThird, 0, kThird},
     {"upper right", 2 * kThird, 1, 0, kThird},
     {"middle left", 0, kThird, kThird, 2 * kThird},
     {"middle", kThird, 2 * kThird, kThird, 2 * kThird},
     {"middle right", 2 * kThird, 1, kThird, 2 * kThird},
     {"lower left", 0, kThird, 2 * kThird, 1},
     {"lower middle", kThird, 2 * kThird, 2 * kThird, 1},
     {"lower right", 2 * kThird, 1, 2 * kThird, 1},
     {"upper third", 0, 1, 0, kThird},
     {"third between", 0, 1, kThird, 2 * kThird},
     {"lower third", 0, 1, 2 * kThird, 1},
     {"left third", 0, kThird, 0, 1},
     {"upright third between", kThird, 2 * kThird, 0, 1},
     {"right third", 2 * kThird, 1, 0, 1}}};

/// Which of the nine a place is in; what is beyond the image counts to its rim.
constexpr int imageCellAt(double x, double y) {
  const auto third = [](double share) { return share < kThird ? 0 : share < 2 * kThird ? 1 : 2; };
  return 3 * third(y) + third(x);
}

}  // namespace fathom
