#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "audit/correction.h"

namespace fathom {

/// Samples that come in time order, corrected, and handed on in the order of their corrected stamps. Held are
/// those that one yet to come may precede: as long as the clocks are corrected by.
class CorrectedSamples {
 public:
  CorrectedSamples(std::vector<Correction> corrections, Vehicle vehicle,
                   std::function<void(const Sample&)> sink)
      : corrections_(std::move(corrections)), vehicle_(std::move(vehicle)), sink_(std::move(sink)) {
    for (const Correction& correction : corrections_) {
      slowest_ = std::min(slowest_, correction.slowest());
      earlier_s_ = std::max(earlier_s_, correction.earlier_s());
    }
  }

  void push(Sample sample) {
    if (!time_zero_) time_zero_ = sample.time;
    // No stamp yet to come is earlier, corrected.
    const Time safe = after(*time_zero_, slowest_ * secondsBetween(*time_zero_, sample.time) - earlier_s_);
    for (const Correction& correction : corrections_) correction.apply(sample, vehicle_, *time_zero_);
    held_.emplace(sample.time, std::move(sample));
    while (!held_.empty() && held_.begin()->first <= safe) release();
  }
  /// Hands on all that are held.
  void flush() {
    while (!held_.empty()) release();
  }

 private:
  void release() {
    sink_(held_.begin()->second);
    held_.erase(held_.begin());
  }

  const std::vector<Correction> corrections_;
  const Vehicle vehicle_;
  std::function<void(const Sample&)> sink_;
  double slowest_ = 1, earlier_s_ = 0;
  std::optional<Time> time_zero_;
  std::multimap<Time, Sample> held_;
};

}  // namespace fathom
