#pragma once

#include <tbb/parallel_for.h>

#include <mutex>
#include <string>

#include "core/progress.h"

namespace fathom {

/// A progress line that several threads move on.
class SharedProgress {
 public:
  SharedProgress(std::string what, std::size_t total) : progress_(std::move(what)), total_(total) {}
  /// One more of the total. Throws Interrupted.
  void oneDone() {
    const std::scoped_lock lock(mutex_);
    progress_.update(static_cast<double>(++done_) / static_cast<double>(total_));
  }

 private:
  std::mutex mutex_;
  Progress progress_;
  std::size_t done_ = 0, total_;
};

/// Calls make(i) for each i below count, on all cores, one at a time to whichever is free. What make throws,
/// or Interrupted, ends it.
template <class Make>
void forEachIndex(std::size_t count, SharedProgress& progress, const Make& make) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          make(i);
          progress.oneDone();
        }
      },
      tbb::simple_partitioner());
}

/// The same with a progress line of its own.
template <class Make>
void forEachIndex(std::size_t count, const std::string& what, const Make& make) {
  SharedProgress progress(what, count);
  forEachIndex(count, progress, make);
}

}  // namespace fathom
