#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include "recording/samples.h"

namespace fathom {

/// Puts samples in time order as they come, within a window.
class ReorderBuffer {
 public:
  /// sink: called with each sample, in time order.
  ReorderBuffer(double window_s, std::function<void(Sample&&)> sink)
      : window_s_(window_s), sink_(std::move(sink)) {}

  /// Not where a sample of this time is older than another one by more than the window, which no order mends.
  bool fits(Time time) const {
    return !newest_ || !(secondsBetween(time, *newest_) > window_s_ || (last_ && time < *last_));
  }
  /// One that fits.
  void push(Sample sample) {
    newest_ = newest_ ? std::max(*newest_, sample.time) : sample.time;
    waiting_.emplace(sample.time, std::move(sample));
    while (secondsBetween(waiting_.begin()->first, waiting_.rbegin()->first) > window_s_) release();
  }
  /// The waiting beams of this time, if any.
  DvlBeamsSample* beamsAt(Time time) {
    const auto [first, end] = waiting_.equal_range(time);
    for (auto it = first; it != end; ++it)
      if (auto* beams = std::get_if<DvlBeamsSample>(&it->second.reading)) return beams;
    return nullptr;
  }
  /// Hands out all that wait.
  void flush() {
    while (!waiting_.empty()) release();
  }
  /// Of the first sample that was handed out.
  std::optional<Time> first() const { return first_; }
  /// Of the last one.
  std::optional<Time> last() const { return last_; }

 private:
  void release() {
    const auto oldest = waiting_.begin();
    last_ = oldest->first;
    if (!first_) first_ = last_;
    sink_(std::move(oldest->second));
    waiting_.erase(oldest);
  }

  double window_s_;
  std::function<void(Sample&&)> sink_;
  std::multimap<Time, Sample> waiting_;
  std::optional<Time> first_, last_, newest_;
};

}  // namespace fathom
