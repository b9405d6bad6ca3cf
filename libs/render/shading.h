#pragma once

#include "panel/surface.h"
#include "render/renderer.h"

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

/// Radiance (red, green, blue each) and slant range (m) of `count` lines of sight (x[i], y[i], 1) that meet
/// the triangle's plane.
void shade(const SeenTriangle& triangle, const SeenLighting& lighting, const float* x, const float* y,
           int count, float* radiance, float* range_m);

}  // namespace fathom
