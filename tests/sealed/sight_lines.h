#pragma once

#include <vector>

#include "port.h"

namespace fathom::sealed {

/// The true camera's lines of sight over its image, traced on a grid of four pixels and linear between: less
/// than a thousandth of a pixel off.
class SightLines {
 public:
  SightLines(const TrueCamera& camera, int width_px, int height_px);

  /// direction.z is 1 here.
  Ray at(const Vector2d& pixel) const;
  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }

 private:
  int width_px_, height_px_, columns_, rows_;
  std::vector<Ray> rays_;
};

}  // namespace fathom::sealed
