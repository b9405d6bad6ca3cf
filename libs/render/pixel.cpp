#include "render/pixel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom {

PixelSampler::PixelSampler(int side) {
  const auto place = [side](int cell, int shear) {
    return static_cast<float>((cell + (shear + 0.5) / side) / side - 0.5);
  };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      column_.push_back(place(i, j));
      row_.push_back(place(j, side - 1 - i));
    }
  column_.push_back(0);
  row_.push_back(0);
  nearness_.resize(column_.size());
  hit_.resize(column_.size());
}

void PixelSampler::findFirstHits(const TriangleInPixel& triangle, int number) {
  const Eigen::Vector3f at = triangle.at_centre, u = triangle.to_next_column, v = triangle.to_next_row;
  const float* column = column_.data();
  const float* row = row_.data();
  float* nearness = nearness_.data();
  int* hit = hit_.data();
  const std::size_t count = hit_.size();
  for (std::size_t k = 0; k < count; ++k) {
    const float a = at[0] + u[0] * column[k] + v[0] * row[k];
    const float b = at[1] + u[1] * column[k] + v[1] * row[k];
    const float c = at[2] + u[2] * column[k] + v[2] * row[k];
    const float least = std::min(a, std::min(b, c)), sum = a + b + c;
    const bool nearest = (least >= 0.0f) & (sum > nearness[k]);
    nearness[k] = nearest ? sum : nearness[k];
    hit[k] = nearest ? number : hit[k];
  }
}

bool PixelSampler::sample(const PixelSquare& pixel, const std::vector<TriangleInPixel>& triangles,
                          bool nothing_behind, const SeenLighting& lighting, float* radiance,
                          float* range_m) {
  std::fill(nearness_.begin(), nearness_.end(), 0.0f);
  std::fill(hit_.begin(), hit_.end(), -1);
  const int count = static_cast<int>(triangles.size());
  for (int i = 0; i < count; ++i) findFirstHits(triangles[static_cast<std::size_t>(i)], i);

  const std::size_t samples = hit_.size() - 1;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero(), light = sum;
  float all_hits = 0, most_hits = 0, nearness = nearness_.back();
  for (int i = 0; i < count; ++i) {
    float hits = 0;
    Eigen::Vector2f middle = Eigen::Vector2f::Zero();
    for (std::size_t k = 0; k < samples; ++k) {
      if (hit_[k] != i) continue;
      hits += 1;
      middle += column_[k] * pixel.to_next_column + row_[k] * pixel.to_next_row;
    }
    if (hits == 0) continue;
    middle = pixel.centre + middle / hits;
    const TriangleInPixel& here = triangles[static_cast<std::size_t>(i)];
    shade(*here.triangle, lighting, &middle.x(), &middle.y(), 1, light.data(), range_m);
    sum += hits * light;
    all_hits += hits;
    if (hits > most_hits && hit_.back() < 0 && !nothing_behind) nearness = here.at_centre.sum();
    most_hits = std::max(most_hits, hits);
  }
  if (all_hits == 0) return false;
  const float weight = 1.0f / (nothing_behind ? static_cast<float>(samples) : all_hits);
  for (int c = 0; c < 3; ++c) radiance[c] = weight * sum[c];
  *range_m =
      nearness > 0 ? pixel.centre.homogeneous().norm() / nearness : std::numeric_limits<float>::infinity();
  return true;
}

}  // namespace fathom
