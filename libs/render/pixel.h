#pragma once

#include <vector>

#include "render/shading.h"

namespace fathom {

/// A pixel's square in ideal image coordinates: its centre, and the way along the image's axes to the next
/// column's and the next row's.
struct PixelSquare {
  Eigen::Vector2f centre, to_next_column, to_next_row;
};

/// A triangle seen from around a pixel: its corner shares over z (see SeenTriangle) at the pixel's centre,
/// and their change to the next column and row.
struct TriangleInPixel {
  const SeenTriangle* triangle;
  Eigen::Vector3f at_centre, to_next_column, to_next_row;

  TriangleInPixel(const SeenTriangle& seen, const PixelSquare& pixel)
      : triangle(&seen),
        at_centre((seen.corner_shares * pixel.centre.cast<double>().homogeneous()).cast<float>()),
        to_next_column(seen.corner_shares.leftCols<2>().cast<float>() * pixel.to_next_column),
        to_next_row(seen.corner_shares.leftCols<2>().cast<float>() * pixel.to_next_row) {}

  bool fillsPixel() const { return (at_centre - reach()).minCoeff() >= 0; }
  bool missesPixel() const { return (at_centre + reach()).minCoeff() < 0; }

 private:
  Eigen::Vector3f reach() const { return 0.5f * (to_next_column.cwiseAbs() + to_next_row.cwiseAbs()); }
};

/// Makes a pixel that several triangles share.
class PixelSampler {
 public:
  /// `side`² samples on a turned grid: along an axis of the image no two coincide, so that edges along the
  /// axes come out as finely as any others, and offsets along the two axes have no covariance, so that edges
  /// aslant are as sharp one way as the other.
  explicit PixelSampler(int side);

  /// Radiance: the mean over the samples, each triangle's light taken in the middle of its samples. Range: at
  /// the pixel's centre. Where no triangle is hit there is nothing if `nothing_behind`, otherwise a triangle
  /// too narrow to be among these: such a sample does not count, and such a centre takes the range of the
  /// plane that most samples hit. Returns whether any sample hit.
  bool sample(const PixelSquare& pixel, const std::vector<TriangleInPixel>& triangles, bool nothing_behind,
              const SeenLighting& lighting, float* radiance, float* range_m);

 private:
  void findFirstHits(const TriangleInPixel& triangle, int number);

  std::vector<float> column_, row_;  // from the pixel's centre, in pixels; the centre itself comes last
  std::vector<float> nearness_;      // by sample: largest 1/z so far …
  std::vector<int> hit_;             // … and whose it is
};

}  // namespace fathom
