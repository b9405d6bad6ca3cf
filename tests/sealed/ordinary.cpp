#include "ordinary.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "panel_design.h"

namespace fathom::sealed {
namespace {

constexpr int kWaves = 24;

}  // namespace

SmoothField::SmoothField(double sigma, double length, Random random)
    : amplitude_(sigma * std::sqrt(2.0 / kWaves)) {
  for (int i = 0; i < kWaves; ++i) {
    const Vector3d number = random.normal3() / length;
    waves_.push_back({number, random.uniform(0, 2 * std::numbers::pi)});
  }
}

double SmoothField::at(const Vector3d& place) const {
  double sum = 0;
  for (const Wave& wave : waves_) sum += std::cos(wave.number.dot(place) + wave.phase_rad);
  return amplitude_ * sum;
}

FieldTable::FieldTable(const SmoothField& field, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                       double step)
    : low_(low),
      step_(step),
      columns_(static_cast<int>(std::ceil((high.x() - low.x()) / step)) + 2),
      rows_(static_cast<int>(std::ceil((high.y() - low.y()) / step)) + 2) {
  if (field.isZero()) return;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column)
      values_.push_back(field.at(Vector3d(low.x() + column * step, low.y() + row * step, 0)));
}

double FieldTable::at(double x, double y) const {
  if (isZero()) return 0;
  const double across = std::clamp((x - low_.x()) / step_, 0.0, columns_ - 1.001);
  const double up = std::clamp((y - low_.y()) / step_, 0.0, rows_ - 1.001);
  const int column = static_cast<int>(across), row = static_cast<int>(up);
  const double* first = &values_[static_cast<std::size_t>(row * columns_ + column)];
  const double* next = first + columns_;
  const double right = across - column, above = up - row;
  return (1 - above) * ((1 - right) * first[0] + right * first[1]) +
         above * ((1 - right) * next[0] + right * next[1]);
}

FieldTable onPanel(const SmoothField& field) {
  constexpr double kMargin_m = 0.1, kStep_m = 0.01, kFoot_m = -(kFloorDepth_m + kPanelZ_m);
  return {field,
          {-kHalfWidth_m - kMargin_m, kFoot_m - kMargin_m},
          {kHalfWidth_m + kMargin_m, kHalfHeight_m + kMargin_m},
          kStep_m};
}

SmoothField ordinaryField(const SealedCase& sealed, double sigma, double length, Stream which,
                          std::uint64_t index) {
  if (sealed.ordinary == 0) return {};
  return {sealed.ordinary * sigma, length, streamOf(sealed.seed, which, index)};
}

double ordinaryEdgeGrowth_px(const SealedCase& sealed) {
  if (sealed.ordinary == 0) return 0;
  const double growth_px = sealed.ordinary * kOrdinary.edge_px * stream(sealed.seed, Stream::edges).normal();
  return sealed.dive.images ? std::abs(growth_px) : growth_px;
}

}  // namespace fathom::sealed
