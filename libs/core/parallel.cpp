#include "core/parallel.h"

#include <tbb/parallel_for.h>

#include "core/for_each.h"

namespace fathom {

void detail::parallelFor(std::size_t count, const void* body, void (*call)(const void* body, std::size_t i)) {
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { call(body, i); });
}

void forEachIndex(std::size_t count, SharedProgress& progress, const std::function<void(std::size_t)>& make) {
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

void forEachIndex(std::size_t count, const std::string& what, const std::function<void(std::size_t)>& make) {
  SharedProgress progress(what, count);
  forEachIndex(count, progress, make);
}

}  // namespace fathom
