#include "sea_trial/clocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "core/text.h"
#include "sea_trial/aligned_streams.h"

namespace fathom {
namespace {

struct Alignment {
  double offset_s = 0.0;
  double residual_rad = 1e300;
};

/// Turned between one row and the next, rad.
std::vector<double> turnedAngles(const std::vector<Matrix3d>& attitude) {
  std::vector<double> angle;
  for (std::size_t k = 0; k + 1 < attitude.size(); ++k)
    angle.push_back(angleBetween(attitude[k], attitude[k + 1]));
  return angle;
}

/// What a gyro that says nothing leaves: RMS about the mean.
double variation(const std::vector<double>& values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += std::pow(value - mean, 2);
  return rootMeanSquare(sum, values.size());
}

/// The offset at which the angle turned between rows agrees best with the gyro's: angles have no axes.
Alignment alignTurnedAngles(const SampledSignal& turned_imu, const std::vector<double>& gt_time_s,
                            const std::vector<double>& angle) {
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
  const auto angle = turnedAngles(attitudesNed(data, Vector3d::Ones()));
  const double rows = static_cast<double>(data.gt_time_s.size());
  const double stretch = (rows - 1.0) / rows;
  const Alignment stamped = alignTurnedAngles(turned_imu, data.gt_time_s, angle);
  const Alignment restored = alignTurnedAngles(turned_imu, stretched(data.gt_time_s, stretch), angle);
  if (stamped.residual_rad == 1e300)
    throw std::invalid_argument("IMU and navigation solution hardly overlap in time");
  const double told = variation(angle) / std::min(stamped.residual_rad, restored.residual_rad);
  const bool is_told = told >= kDecisiveRatio;
  const bool is_stretched = is_told && restored.residual_rad * kDecisiveRatio < stamped.residual_rad;
  const Alignment& best = is_stretched ? restored : stamped;
  const Alignment& other = is_stretched ? stamped : restored;
  c.stamp_stretch = is_stretched ? stretch : 1.0;
  c.imu_offset_s = is_told ? best.offset_s : 0.0;

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
  const std::string fits = print("a row stamped t%s fits the IMU at t %+.3f s",
                                 is_stretched ? " (stretch undone)" : "", best.offset_s);
  const std::string compared = "the same comparison; angles do not depend on axes";
  const bool is_contradicted = !is_told && best.residual_rad > kContradicting_rad;
  c.conclusions.push_back({"time alignment of navigation solution and IMU",
                           is_told ? fits
                           : is_contradicted
                               ? "left as stamped, as the gyro does not turn as the solution does"
                               : "left as stamped: the vehicle turns too little to tell",
                           is_contradicted ? fits : "", is_contradicted ? told : 0.0,
                           compared + print("; the solution's vary by %.3g rad", variation(angle))});
}

}  // namespace fathom
