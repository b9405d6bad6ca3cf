#pragma once

#include <functional>
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
void forEachIndex(std::size_t count, SharedProgress& progress, const std::function<void(std::size_t)>& make);

/// The same with a progress line of its own.
void forEachIndex(std::size_t count, const std::string& what, const std::function<void(std::size_t)>& make);

}  // namespace fathom
