#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
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

inline constexpr std::size_t kAsManyAsCores = std::numeric_limits<std::size_t>::max();

/// Of images of so many pixels, how many are worked on at once, so that memory does not grow with cores times
/// pixels: all cores' of 640x480, one of 3840x2160 (whose rows then share the cores).
inline std::size_t imagesAtOnce(int width_px, int height_px) {
  constexpr double kPixels = 12e6;
  return static_cast<std::size_t>(std::max(1.0, kPixels / std::max(1.0, 1.0 * width_px * height_px)));
}

/// Calls make(i) for each i below count, on all cores, one at a time to whichever is free, no more than
/// `at_once` at a time. What make throws, or Interrupted, ends it.
void forEachIndex(std::size_t count, SharedProgress& progress, const std::function<void(std::size_t)>& make,
                  std::size_t at_once = kAsManyAsCores);

/// The same with a progress line of its own.
void forEachIndex(std::size_t count, const std::string& what, const std::function<void(std::size_t)>& make,
                  std::size_t at_once = kAsManyAsCores);

}  // namespace fathom
