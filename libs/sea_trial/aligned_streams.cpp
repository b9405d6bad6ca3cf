#include "sea_trial/aligned_streams.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace fathom {

std::vector<double> stretched(std::vector<double> time_s, double factor) {
  for (double& t : time_s) t = time_s.front() + (t - time_s.front()) * factor;
  return time_s;
}

SampledSignal velocityFrd(const AlignedStreams& s, const std::vector<Matrix3d>& R_ned_frd) {
  std::vector<Vector3d> velocity_frd;
  for (std::size_t k = 0; k < R_ned_frd.size(); ++k)
    velocity_frd.emplace_back(R_ned_frd[k].transpose() * s.data.velocity_ned[k]);
  return {s.gt_time_s, std::move(velocity_frd)};
}

double rootMeanSquare(double sum_of_squares, std::size_t count) {
  return std::sqrt(sum_of_squares / static_cast<double>(std::max<std::size_t>(count, 1)));
}

std::string printVector(const char* number_format, const Vector3d& v) {
  std::string text = "(";
  for (int i = 0; i < 3; ++i) {
    if (i > 0) text += ", ";
    text += print(number_format, v[i]);
  }
  return text + ")";
}

}  // namespace fathom
