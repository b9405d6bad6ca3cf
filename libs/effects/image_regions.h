#pragma once

#include <algorithm>
#include <array>
#include <numbers>
#include <string_view>

#include "core/camera_model.h"

namespace fathom {

/// A part of an image: shares of its width and height, from the left and from above.
struct ImageRegion {
  std::string_view name;
  double left, right, top, bottom;

  bool contains(const Vector2d& place) const {
    return place.x() >= left && place.x() < right && place.y() >= top && place.y() < bottom;
  }
  /// How much of what has this middle and these standard deviations lies in it, being an upright rectangle.
  double shareOf(const Vector2d& place, const Vector2d& spread) const {
    if (spread.isZero(0)) return contains(place) ? 1 : 0;
    return within(place.x(), spread.x(), left, right) * within(place.y(), spread.y(), top, bottom);
  }

  static double within(double middle, double spread, double from, double to) {
    const double half = std::max(1e-9, std::numbers::sqrt3 * spread);
    return std::max(0.0, std::min(to, middle + half) - std::max(from, middle - half)) / (2 * half);
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
