#include "sea_trial/columns.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "sea_trial/aligned_streams.h"

namespace fathom {
namespace {

double positionResidual(const SeaTrialData& data, bool swapped) {
  const auto position = positionsEnu(data, swapped, 1);
  const SampledSignal travelled = SampledSignal(data.gt_time_s, data.velocity_ned).integral();
  std::vector<Vector3d> difference;
  Vector3d mean = Vector3d::Zero();
  for (std::size_t k = 0; k < position.size(); ++k) {
    difference.emplace_back(position[k] - swapNedEnu() * travelled.at(data.gt_time_s[k]));
    mean += difference.back() / static_cast<double>(position.size());
  }
  double sum = 0.0;
  for (const Vector3d& d : difference) sum += (d - mean).head<2>().squaredNorm();
  return rootMeanSquare(sum, position.size());
}

}  // namespace

void settlePositionColumns(const SeaTrialData& data, SeaTrialConventions& c) {
  const double named = positionResidual(data, false), swapped = positionResidual(data, true);
  c.position_columns_swapped = swapped * kDecisiveRatio < named;
  const double best = c.position_columns_swapped ? swapped : named;
  const double other = c.position_columns_swapped ? named : swapped;
  constexpr const char *kNamed = "as named", *kSwapped = "names swapped";
  const double latitude = c.position_columns_swapped ? data.longitude_rad[0] : data.latitude_rad[0];
  const double longitude = c.position_columns_swapped ? data.latitude_rad[0] : data.longitude_rad[0];
  c.conclusions.push_back(
      {"longitude and latitude columns", c.position_columns_swapped ? kSwapped : kNamed,
       c.position_columns_swapped ? kNamed : kSwapped, other / best,
       print("position minus integrated V north and V east, RMS %.3g m against %.4g m; the section starts at "
             "%.5f deg north, %.5f deg east",
             best, other, degrees(latitude), degrees(longitude))});
}

void settleAltitude(const SeaTrialData& data, SeaTrialConventions& c) {
  double up = 0.0, down = 0.0;
  const std::size_t rows = data.gt_time_s.size();
  for (std::size_t k = 1; k + 1 < rows; ++k) {
    const double climb =
        (data.altitude_m[k + 1] - data.altitude_m[k - 1]) / (data.gt_time_s[k + 1] - data.gt_time_s[k - 1]);
    up += std::pow(climb + data.velocity_ned[k].z(), 2);
    down += std::pow(climb - data.velocity_ned[k].z(), 2);
  }
  up = rootMeanSquare(up, rows - 2);
  down = rootMeanSquare(down, rows - 2);
  c.altitude_sign = down * kDecisiveRatio < up ? -1 : 1;
  const bool is_up = c.altitude_sign > 0;
  c.conclusions.push_back({"altitude column", is_up ? "positive up" : "positive down",
                           is_up ? "positive down" : "positive up",
                           std::max(is_up ? down / up : up / down, 1.0),
                           print("its slope against -V down, RMS %.3g m/s against %.3g m/s",
                                 is_up ? up : down, is_up ? down : up)});
}

}  // namespace fathom
