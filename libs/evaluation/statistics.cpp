#include "evaluation/statistics.h"

#include <algorithm>
#include <cmath>

namespace fathom {

ErrorSummary summaryOf(std::vector<double> errors) {
  ErrorSummary summary;
  summary.count = errors.size();
  if (errors.empty()) return summary;
  const auto n = static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end());  // also makes the sums independent of the order given
  summary.mean = 0;
  for (const double error : errors) summary.mean += error / n;
  double variance = 0;
  for (const double error : errors) variance += (error - summary.mean) * (error - summary.mean) / n;
  summary.sigma = std::sqrt(variance);
  summary.median = 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]);
  summary.largest = errors.back();
  return summary;
}

std::vector<Bin> binsOf(double low, double high, double width) {
  const int count = std::max(1, static_cast<int>(std::ceil((high - low) / width - 1e-9)));
  std::vector<Bin> bins;
  for (int k = 0; k < count; ++k)
    bins.push_back({low + k * width, k + 1 == count ? high : low + (k + 1) * width, k + 1 == count});
  return bins;
}

}  // namespace fathom
