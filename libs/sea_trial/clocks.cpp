#include "sea_trial/clocks.h"

#include <cmath>
#include <stdexcept>

#include "core/text.h"
#include "sea_trial/aligned_streams.h"

namespace fathom {
namespace {

struct Alignment {
  double offset_s = 0.0;
  double residual_rad = 1e300;
};

/// The offset at which the angle turned between rows agrees best with the gyro's: angles have no axes.
Alignment alignTurnedAngles(const SampledSignal& turned_imu, const std::vector<double>& gt_time_s,
                            const std::vector<Matrix3d>& attitude) {
  std::vector<double> angle;
  for (std::size_t k = 0; k + 1 < attitude.size(); ++k)
    angle.push_back(angleBetween(attitude[k], attitude[k + 1]));
  const auto residual = [&](double offset) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t k = 0; k < angle.size(); ++k) {
      const double from = gt_time_s[k] + offset, to = gt_time_s[k + 1] + offset;
      if (!turned_imu.covers(from, to)) continue;
      sum += std::pow((turned_imu.at(to) - turned_imu.at(from)).norm() - angle[k], 2);
      ++count;
    }
    return count * 2 < angle.size() ? 1e300 : rootMeanSquare(sum, count);
  };
  Alignment best{0.0, residual(0.0)};
  const auto search = [&](double centre, int steps, double step) {
    for (int k = -steps; k <= steps; ++k)
      if (const double r = residual(centre + k * step); r < best.residual_rad) best = {centre + k * step, r};
  };
  search(0.0, static_cast<int>(kLongestDelay_s / 0.02), 0.02);
  search(best.offset_s, 20, 0.001);
  return best;
}

}  // namespace

void settleClocks(const SeaTrialData& data, const SampledSignal& turned_imu, SeaTrialConventions& c) {
  const auto attitude = attitudesNed(data, Vector3d::Ones());
  const double rows = static_cast<double>(data.gt_time_s.size());
  const double stretch = (rows - 1.0) / rows;
  const Alignment stamped = alignTurnedAngles(turned_imu, data.gt_time_s, attitude);
  const Alignment restored = alignTurnedAngles(turned_imu, stretched(data.gt_time_s, stretch), attitude);
  if (stamped.residual_rad == 1e300)
    throw std::invalid_argument("IMU and navigation solution hardly overlap in time");
  const bool is_stretched = restored.residual_rad * kDecisiveRatio < stamped.residual_rad;
  const Alignment& best = is_stretched ? restored : stamped;
  const Alignment& other = is_stretched ? stamped : restored;
  c.stamp_stretch = is_stretched ? stretch : 1.0;
  c.imu_offset_s = best.offset_s;

  const double step =
      (data.gt_time_s.back() - data.gt_time_s.front()) / (static_cast<double>(data.gt_time_s.size()) - 1.0);
  const std::string as_stamped = print("%.6f s apart, as stamped", step);
  const std::string as_restored = print("%.6f s apart, stamps stretched by N/(N-1)", step * stretch);
  c.conclusions.push_back(
      {"stamps of DVL and navigation solution", is_stretched ? as_restored : as_stamped,
       is_stretched ? as_stamped : as_restored, other.residual_rad / best.residual_rad,
       print("angle turned between rows, attitude against gyro, each at its best constant offset: RMS %.3g "
             "rad against %.3g rad",
             best.residual_rad, other.residual_rad)});
  c.conclusions.push_back({"time alignment of navigation solution and IMU",
                           print("a row stamped t%s fits the IMU at t %+.3f s",
                                 is_stretched ? " (stretch undone)" : "", best.offset_s),
                           "", 0.0, "the same comparison; angles do not depend on axes"});
}

}  // namespace fathom
