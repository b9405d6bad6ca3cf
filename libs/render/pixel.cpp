#include "render/pixel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom {
namespace {

constexpr std::size_t kLanes = 8;  // samples that the compiler may look at side by side

/// Of a place that is `steps` steps from the corner on, in pixels from the centre; samples are in the middle
/// of their step.
float offsetOf(float steps, int side) { return (steps + 0.5f) / static_cast<float>(side * side) - 0.5f; }

}  // namespace

PixelSampler::PixelSampler(int side) : side_(side) {
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      column_step_.push_back(i * side + j);
      row_step_.push_back(j * side + side - 1 - i);
    }
  const std::size_t samples = column_step_.size();
  const std::size_t padded = (samples + kLanes) / kLanes * kLanes;  // one more at least: the centre
  for (std::size_t k = 0; k < samples; ++k) {
    column_.push_back(offsetOf(static_cast<float>(column_step_[k]), side));
    row_.push_back(offsetOf(static_cast<float>(row_step_[k]), side));
  }
  for (auto* values : {&column_, &row_, &nearness_}) values->resize(padded);
  for (auto* values : {&column_step_, &row_step_, &hit_}) values->resize(padded);
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
    const float here = least >= 0.0f ? sum : 0.0f, before = nearness[k];
    const int nearest = -static_cast<int>(here > before);  // all bits, or none
    nearness[k] = std::max(here, before);
    hit[k] = (number & nearest) | (hit[k] & ~nearest);
  }
}

/// Its share in samples. Sums of whole numbers, which the compiler may take in any order.
PixelPart PixelSampler::partOf(const TriangleInPixel& triangle, int number, const PixelSquare& pixel) const {
  const int *hit = hit_.data(), *column_step = column_step_.data(), *row_step = row_step_.data();
  int hits = 0, columns = 0, rows = 0;
  const std::size_t all = hit_.size();
  for (std::size_t k = 0; k < all; ++k) {
    const int mine = -static_cast<int>(hit[k] == number);  // all bits, or none
    hits -= mine;
    columns += mine & column_step[k];
    rows += mine & row_step[k];
  }
  if (hits == 0) return {triangle.triangle, pixel.centre, 0};
  const float count = static_cast<float>(hits);
  return {triangle.triangle,
          pixel.centre + offsetOf(static_cast<float>(columns) / count, side_) * pixel.to_next_column +
              offsetOf(static_cast<float>(rows) / count, side_) * pixel.to_next_row,
          count};
}

const std::vector<PixelPart>& PixelSampler::sample(const PixelSquare& pixel,
                                                   const std::vector<TriangleInPixel>& triangles,
                                                   bool nothing_behind) {
  std::fill(nearness_.begin(), nearness_.end(), 0.0f);
  std::fill(hit_.begin(), hit_.end(), -1);
  const int count = static_cast<int>(triangles.size());
  for (int i = 0; i < count; ++i) findFirstHits(triangles[static_cast<std::size_t>(i)], i);

  const auto samples = static_cast<std::size_t>(side_ * side_);
  const bool centre_hit = hit_[samples] >= 0;
  std::fill(hit_.begin() + side_ * side_, hit_.end(), -1);  // what is no sample does not count
  float all_hits = 0, most_hits = 0, nearness = nearness_[samples];
  parts_.clear();
  for (int i = 0; i < count; ++i) {
    const TriangleInPixel& triangle = triangles[static_cast<std::size_t>(i)];
    const PixelPart part = partOf(triangle, i, pixel);
    if (part.share == 0) continue;
    parts_.push_back(part);
    all_hits += part.share;
    if (part.share > most_hits && !centre_hit && !nothing_behind) nearness = triangle.at_centre.sum();
    most_hits = std::max(most_hits, part.share);
  }
  const float counted = nothing_behind ? static_cast<float>(samples) : all_hits;
  for (PixelPart& part : parts_) part.share /= counted;
  range_m_ =
      nearness > 0 ? pixel.centre.homogeneous().norm() / nearness : std::numeric_limits<float>::infinity();
  return parts_;
}

}  // namespace fathom
