#pragma once

#include <cmath>
#include <cstddef>
#include <map>
#include <optional>

namespace fathom {

/// The sigma that most messages have: what one message says (the first one's covariance before the sensor had
/// settled, a lost lock's) is not the sensor's. Memory does not depend on how many there are.
class TypicalSigma {
 public:
  void add(double sigma) {
    if (!(sigma > 0 && std::isfinite(sigma))) return;
    Bin& bin = bins_.try_emplace(std::lround(std::log(sigma) / kRatio), Bin{sigma}).first->second;
    ++bin.count;
    ++count_;
  }
  /// The median, to half a per cent, exactly where all are alike; nothing where none was given.
  std::optional<double> typical() const {
    std::size_t below = 0;
    for (const auto& [place, bin] : bins_)
      if (2 * (below += bin.count) >= count_) return bin.first;
    return {};
  }

 private:
  static constexpr double kRatio = 0.01;
  struct Bin {
    double first = 0;
    std::size_t count = 0;
  };
  std::map<long, Bin> bins_;
  std::size_t count_ = 0;
};

}  // namespace fathom
