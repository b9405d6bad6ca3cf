#include "recording/axes.h"

#include <algorithm>

#include "core/stable_sort.h"

namespace fathom {
std::vector<SignedAxes> allAxes() {
  std::vector<SignedAxes> all;
  std::array<int, 3> source{0, 1, 2};
  do {
    for (int bits = 0; bits < 8; ++bits)
      all.push_back({source, {bits & 1 ? -1 : 1, bits & 2 ? -1 : 1, bits & 4 ? -1 : 1}});
  } while (std::next_permutation(source.begin(), source.end()));
  return all;
}

Matrix3d SignedAxes::matrix() const {
  Matrix3d m = Matrix3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) m(static_cast<int>(i), source[i]) = sign[i];
  return m;
}

std::string SignedAxes::text() const {
  std::string text = "(";
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0) text += ", ";
    if (sign[i] < 0) text += '-';
    text += static_cast<char>('x' + source[i]);
  }
  return text + ")";
}

void AxesEvidence::add(const Vector3d& expected, const Vector3d& measured) {
  ++count_;
  product_ += expected * measured.transpose();
  expected_squared_ += expected.cwiseAbs2();
  measured_squared_ += measured.cwiseAbs2();
}

double AxesEvidence::expectedRms() const {
  return std::sqrt(expected_squared_.sum() / static_cast<double>(std::max<std::size_t>(count_, 1)));
}

std::vector<AxesScore> AxesEvidence::ranking() const {
  std::vector<AxesScore> scores;
  const double n = static_cast<double>(std::max<std::size_t>(count_, 1));
  for (const SignedAxes& axes : allAxes()) {
    AxesScore score{axes, 0.0, {}};
    for (int i = 0; i < 3; ++i) {
      const int j = axes.source[static_cast<std::size_t>(i)];
      const double power = expected_squared_[i] + measured_squared_[j];
      const double residual = power - 2.0 * axes.sign[static_cast<std::size_t>(i)] * product_(i, j);
      // Below 1e-12 of the signal's power the difference of sums is rounding, not residual.
      score.residual_rms[i] = std::sqrt(std::max(residual, 1e-12 * power + 1e-30) / n);
      score.log_likelihood -= static_cast<double>(count_) * std::log(score.residual_rms[i]);
    }
    scores.push_back(score);
  }
  stableSort(scores,
             [](const AxesScore& a, const AxesScore& b) { return a.log_likelihood > b.log_likelihood; });
  return scores;
}

}  // namespace fathom
