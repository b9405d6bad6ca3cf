#include "core/parallel.h"

#include <tbb/parallel_for.h>

#include "core/for_each.h"

namespace fathom {

using tbb::task_group_context;

/// Of its own, whoever calls: where one of several bodies throws, a loop within another one would else end in
/// the middle, without a word.
void detail::parallelFor(std::size_t count, const void* body, void (*call)(const void* body, std::size_t i)) {
  task_group_context apart(task_group_context::isolated);
  tbb::parallel_for(
      std::size_t{0}, count, [&](std::size_t i) { call(body, i); }, apart);
}

void forEachIndex(std::size_t count, SharedProgress& progress, const std::function<void(std::size_t)>& make) {
  task_group_context apart(task_group_context::isolated);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          make(i);
          progress.oneDone();
        }
      },
      tbb::simple_partitioner(), apart);
}

void forEachIndex(std::size_t count, const std::string& what, const std::function<void(std::size_t)>& make) {
  SharedProgress progress(what, count);
  forEachIndex(count, progress, make);
}

}  // namespace fathom
