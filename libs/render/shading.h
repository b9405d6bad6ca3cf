#pragma once

#include "panel/surface.h"
#include "render/lighting.h"

namespace fathom {

/// A triangle as the camera sees it. Along the line of sight d = (x/z, y/z, 1) the point z d of its plane is
/// the sum of b_i times corner i, so with the corners as the columns of V, b/z = V^-1 d: three functions
/// linear in the image, not negative inside the triangle, whose sum is 1/z (Olano & Greer 1997). What varies
/// linearly over the triangle, divided by z, is linear in the image too.
struct SeenTriangle {
  Eigen::Matrix3d corner_shares;                       ///< V^-1, 1/m
  Eigen::Vector3f inverse_depth;                       ///< 1/z = inverse_depth . d
  bool uniform = false;                                ///< one normal and one albedo: the next two
  Eigen::Vector3f normal, albedo;                      ///< normal in the camera frame
  Eigen::Matrix3f normal_per_depth, albedo_per_depth;  ///< otherwise these, times z d

  SeenTriangle(const Surface& surface, std::size_t triangle, const Pose& T_camera_odom);
};

/// A lamp in the camera frame.
struct SeenSpot {
  Eigen::Vector3f position, direction, irradiance_1m;
  float cos_half_angle;

  SeenSpot(const Spot& spot, const Pose& T_camera_odom);
};

struct SeenLighting {
  Eigen::Vector3f ambient;
  std::vector<SeenSpot> spots;

  SeenLighting(const Lighting& lighting, const Pose& T_camera_odom);
};

/// Lines of sight that are shaded at a time: a handful of arrays that stay in the cache.
struct ShadingBlock {
  static constexpr int kSize = 64;
  using Values = float[kSize];

  Values x, y, z;        ///< points, camera frame, m
  Values normal[3];      ///< unit length
  Values irradiance[3];  ///< red, green, blue
};

/// Radiance (red, green, blue each) and slant range (m) of `count` lines of sight (x[i], y[i], 1) that meet
/// the triangle's plane.
void shade(const SeenTriangle& triangle, const SeenLighting& lighting, const float* x, const float* y,
           int count, float* radiance, float* range_m);

/// Shades single lines of sight, each on a triangle of its own, many at a time.
class SingleSights {
 public:
  /// Keeps a reference to the lighting.
  explicit SingleSights(const SeenLighting& lighting) : lighting_(lighting) {}
  /// Adds `weight` times the radiance of the line of sight (x, y, 1) to `radiance` (red, green, blue): now,
  /// or when finish() is called.
  void add(const SeenTriangle& triangle, const Eigen::Vector2f& sight, float weight, float* radiance);
  void finish();

 private:
  const SeenLighting& lighting_;
  ShadingBlock block_;
  ShadingBlock::Values albedo_[3], weight_;
  float* radiance_[ShadingBlock::kSize];
  int count_ = 0;
};

}  // namespace fathom
