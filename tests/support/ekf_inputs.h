#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "localization/measurements.h"

namespace fathom::test {

/// One line of ../shared/ekf_inputs: see its README.
struct EkfLine {
  double t = 0;
  std::string sensor;
  std::vector<int> index;
  NavigationState<double> z;  ///< the listed components
  Eigen::MatrixXd R;          ///< covariance, with the attitude's part turned into the rotation vector's
};

EkfLine parseEkfLine(const std::string& text);

struct EkfInputs {
  std::vector<double> Q, P0;
  std::vector<EkfLine> lines;
};

EkfInputs readEkfInputs(const std::filesystem::path& file);

/// Calls f with the line's columns as a compile-time list.
template <int N, class F>
auto withMeasurement(const NavigationState<double>& x, const EkfLine& line, F&& f) {
  const auto make = [&]<int... I>(Columns<I...>) {
    constexpr int M = sizeof...(I);
    return f(
        directMeasurement<N, I...>(x, line.z, Eigen::Map<const Eigen::Matrix<double, M, M>>(line.R.data())));
  };
  const auto& index = line.index;
  if (index.size() == 9) return make(Columns<3, 4, 5, 9, 10, 11, 12, 13, 14>{});
  if (index.size() == 6) return make(Columns<0, 1, 2, 3, 4, 5>{});
  if (index.front() == 3) return make(Columns<3, 4, 5>{});
  if (index.front() == 6) return make(Columns<6, 7, 8>{});
  if (index.front() == 9) return make(Columns<9, 10, 11>{});
  return make(Columns<12, 13, 14>{});
}

/// Feeds a line as its README says: the first sets state and covariance, each later one predicts, then
/// updates.
template <int N>
void feed(ErrorStateFilter<N>& filter, const EkfLine& line, double& last_t, const ProcessNoise& noise) {
  if (line.t > last_t) filter.predict(line.t - last_t, noise);
  last_t = std::max(last_t, line.t);
  withMeasurement<N>(filter.x, line, [&](const auto& m) {
    filter.update(m);
    return 0;
  });
}

}  // namespace fathom::test
