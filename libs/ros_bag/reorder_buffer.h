#pragma once

#include <functional>
#include <map>
#include <optional>

#include "recording/samples.h"
#include "ros_bag/bag_message.h"

namespace fathom {

/// Puts samples in time order as they come, within a window.
class ReorderBuffer {
 public:
  /// sink: called with each sample, in time order.
  ReorderBuffer(double window_s, std::function<void(Sample&&)> sink)
      : window_s_(window_s), sink_(std::move(sink)) {}

  /// Throws Error, about the message, where the sample is older than one that was handed out.
  void push(Sample sample, const BagMessage& message) {
    if (last_ && sample.time < *last_)
      throw message.error("its stamp is older than its predecessors' by more than the reorder window of " +
                          std::to_string(window_s_) + " s");
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
  std::optional<Time> first_, last_;
};

}  // namespace fathom
