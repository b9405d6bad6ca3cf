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
  Eigen::Vector3f reach;  ///< by how much they differ, at most, within the pixel

  TriangleInPixel(const SeenTriangle& seen, const PixelSquare& pixel)
      : triangle(&seen),
        at_centre((seen.corner_shares * pixel.centre.cast<double>().homogeneous()).cast<float>()),
        to_next_column(seen.corner_shares.leftCols<2>().cast<float>() * pixel.to_next_column),
        to_next_row(seen.corner_shares.leftCols<2>().cast<float>() * pixel.to_next_row),
        reach(0.5f * (to_next_column.cwiseAbs() + to_next_row.cwiseAbs())) {}

  bool fillsPixel() const { return (at_centre - reach).minCoeff() >= 0; }
  bool missesPixel() const { return (at_centre + reach).minCoeff() < 0; }
};

/// What a pixel sees of one triangle.
struct PixelPart {
  const SeenTriangle* triangle;
  Eigen::Vector2f middle;  ///< of its samples, ideal image coordinates
  float share;             ///< of the pixel
};

/// Parts a pixel among the triangles that share it.
class PixelSampler {
 public:
  /// `side`² samples on a turned grid: along an axis of the image no two coincide, so that edges along the
  /// axes come out as finely as any others, and offsets along the two axes have no covariance, so that edges
  /// aslant are as sharp one way as the other.
  explicit PixelSampler(int side);

  /// By triangle that is hit, in the order of `triangles`; valid until the next call. Where no triangle is
  /// hit there is nothing if `nothing_behind`, otherwise a triangle too narrow to be among these: such a
  /// sample does not count. None: no sample hit.
  const std::vector<PixelPart>& sample(const PixelSquare& pixel,
                                       const std::vector<TriangleInPixel>& triangles, bool nothing_behind);
  /// At the centre of the pixel that was sampled last, where any sample hit; of a centre that hit none though
  /// something is behind, on the plane that most samples hit.
  float range_m() const { return range_m_; }

 private:
  void findFirstHits(const TriangleInPixel& triangle, int number);
  PixelPart partOf(const TriangleInPixel& triangle, int number, const PixelSquare& pixel) const;

  int side_;
  // By sample; then the pixel's centre; then what fills up the last group of kLanes, in the centre too.
  std::vector<float> column_, row_;          // from the pixel's centre, in pixels
  std::vector<int> column_step_, row_step_;  // the same, in steps of 1 / side² from the pixel's corner
  std::vector<float> nearness_;              // largest 1/z so far …
  std::vector<int> hit_;                     // … and whose it is
  std::vector<PixelPart> parts_;
  float range_m_ = 0;
};

}  // namespace fathom
