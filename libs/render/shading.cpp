#include "render/shading.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "render/faces.h"

namespace fathom {
namespace {

using Block = ShadingBlock;

void placePoint(const Eigen::Vector3f& inverse_depth, float x, float y, int i, Block& b) {
  const float z = 1.0f / (inverse_depth.x() * x + inverse_depth.y() * y + inverse_depth.z());
  b.x[i] = z * x;
  b.y[i] = z * y;
  b.z[i] = z;
}

void placePoints(const Eigen::Vector3f& inverse_depth, const float* x, const float* y, int count, Block& b,
                 float* range_m) {
  for (int i = 0; i < count; ++i) {
    placePoint(inverse_depth, x[i], y[i], i, b);
    range_m[i] = b.z[i] * std::sqrt(x[i] * x[i] + y[i] * y[i] + 1.0f);
  }
}

float along(const Eigen::Matrix3f& per_depth, int row, const Block& b, int i) {
  return per_depth(row, 0) * b.x[i] + per_depth(row, 1) * b.y[i] + per_depth(row, 2) * b.z[i];
}

/// Of a triangle whose normal varies.
void placeNormal(const SeenTriangle& triangle, int i, Block& b) {
  const float nx = along(triangle.normal_per_depth, 0, b, i);
  const float ny = along(triangle.normal_per_depth, 1, b, i);
  const float nz = along(triangle.normal_per_depth, 2, b, i);
  const float scale = 1.0f / std::sqrt(std::max(nx * nx + ny * ny + nz * nz, 1e-20f));
  b.normal[0][i] = scale * nx;
  b.normal[1][i] = scale * ny;
  b.normal[2][i] = scale * nz;
}

void placeNormals(const SeenTriangle& triangle, int count, Block& b) {
  if (triangle.uniform) {
    for (int k = 0; k < 3; ++k) std::fill_n(b.normal[k], count, triangle.normal[k]);
    return;
  }
  for (int i = 0; i < count; ++i) placeNormal(triangle, i, b);
}

void addSpot(const SeenSpot& spot, int count, Block& b) {
  const Eigen::Vector3f& p = spot.position;
  const Eigen::Vector3f& d = spot.direction;
  Block::Values strength;
  for (int i = 0; i < count; ++i) {
    const float x = p.x() - b.x[i], y = p.y() - b.y[i], z = p.z() - b.z[i];  // to the lamp
    const float inverse_distance = 1.0f / std::sqrt(x * x + y * y + z * z);
    const float cos_incidence =
        (x * b.normal[0][i] + y * b.normal[1][i] + z * b.normal[2][i]) * inverse_distance;
    const float cos_off_axis = -(x * d.x() + y * d.y() + z * d.z()) * inverse_distance;
    const float irradiance = std::max(cos_incidence, 0.0f) * inverse_distance * inverse_distance;
    strength[i] = cos_off_axis >= spot.cos_half_angle ? irradiance : 0.0f;
  }
  for (int c = 0; c < 3; ++c) {
    const float irradiance_1m = spot.irradiance_1m[c];
    for (int i = 0; i < count; ++i) b.irradiance[c][i] += irradiance_1m * strength[i];
  }
}

void light(const SeenLighting& lighting, int count, Block& b) {
  for (int c = 0; c < 3; ++c) std::fill_n(b.irradiance[c], count, lighting.ambient[c]);
  for (const SeenSpot& spot : lighting.spots) addSpot(spot, count, b);
}

void reflect(const SeenTriangle& triangle, int count, Block& b) {
  for (int c = 0; c < 3; ++c) {
    const float albedo = triangle.albedo[c];
    if (triangle.uniform)
      for (int i = 0; i < count; ++i) b.irradiance[c][i] *= albedo;
    else
      for (int i = 0; i < count; ++i) b.irradiance[c][i] *= along(triangle.albedo_per_depth, c, b, i);
  }
}

void shadeBlock(const SeenTriangle& triangle, const SeenLighting& lighting, const float* x, const float* y,
                int count, float* radiance, float* range_m) {
  Block b;
  placePoints(triangle.inverse_depth, x, y, count, b, range_m);
  if (!lighting.spots.empty()) placeNormals(triangle, count, b);
  light(lighting, count, b);
  reflect(triangle, count, b);
  for (int i = 0; i < count; ++i)
    for (int c = 0; c < 3; ++c) radiance[3 * i + c] = b.irradiance[c][i];
}

}  // namespace

void shade(const SeenTriangle& triangle, const SeenLighting& lighting, const float* x, const float* y,
           int count, float* radiance, float* range_m) {
  for (int first = 0; first < count; first += Block::kSize)
    shadeBlock(triangle, lighting, x + first, y + first, std::min(Block::kSize, count - first),
               radiance + static_cast<std::ptrdiff_t>(3) * first, range_m + first);
}

void SingleSights::add(const SeenTriangle& triangle, const Eigen::Vector2f& sight, float weight,
                       float* radiance) {
  if (count_ == Block::kSize) finish();
  const int i = count_++;
  placePoint(triangle.inverse_depth, sight.x(), sight.y(), i, block_);
  if (!triangle.uniform) placeNormal(triangle, i, block_);
  for (int k = 0; k < 3; ++k) {
    if (triangle.uniform) block_.normal[k][i] = triangle.normal[k];
    albedo_[k][i] = triangle.uniform ? triangle.albedo[k] : along(triangle.albedo_per_depth, k, block_, i);
  }
  weight_[i] = weight;
  radiance_[i] = radiance;
}

void SingleSights::finish() {
  light(lighting_, count_, block_);
  for (int i = 0; i < count_; ++i)
    for (int c = 0; c < 3; ++c) radiance_[i][c] += weight_[i] * albedo_[c][i] * block_.irradiance[c][i];
  count_ = 0;
}

SeenTriangle::SeenTriangle(const Surface& surface, std::size_t triangle, const Pose& T_camera_odom)
    : uniform(isUniform(surface, triangle)) {
  Matrix3d corners_camera;
  Eigen::Matrix3f normals_camera, albedos;
  const Eigen::Matrix3f R_camera_odom = T_camera_odom.rotation.cast<float>();
  for (int i = 0; i < 3; ++i) {
    const auto& vertex = surface.vertices[surface.triangles[triangle][static_cast<std::size_t>(i)]];
    corners_camera.col(i) = T_camera_odom * Vector3d(vertex.position.cast<double>());
    normals_camera.col(i) = R_camera_odom * vertex.normal;
    albedos.col(i) = vertex.albedo;
  }
  corner_shares = corners_camera.inverse();
  const Eigen::Matrix3f shares = corner_shares.cast<float>();
  inverse_depth = corner_shares.colwise().sum().transpose().cast<float>();
  normal = normals_camera.col(0).normalized();
  albedo = albedos.col(0);
  normal_per_depth = normals_camera * shares;
  albedo_per_depth = albedos * shares;
}

SeenSpot::SeenSpot(const Spot& spot, const Pose& T_camera_odom)
    : irradiance_1m(spot.irradiance_1m), cos_half_angle(static_cast<float>(std::cos(spot.half_angle_rad))) {
  const Pose T_camera_lamp = T_camera_odom * spot.T_odom_lamp;
  position = T_camera_lamp.position.cast<float>();
  direction = T_camera_lamp.rotation.col(0).cast<float>();
}

SeenLighting::SeenLighting(const Lighting& lighting, const Pose& T_camera_odom) : ambient(lighting.ambient) {
  for (const Spot& spot : lighting.spots) spots.emplace_back(spot, T_camera_odom);
}

}  // namespace fathom
