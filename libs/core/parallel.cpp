#include "core/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

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

void forEachIndex(std::size_t count, SharedProgress& progress, const std::function<void(std::size_t)>& make,
                  std::size_t at_once) {
  task_group_context apart(task_group_context::isolated);
  const auto makeOne = [&](std::size_t i) {
    make(i);
    progress.oneDone();
  };
  if (at_once >= count) {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) makeOne(i);
        },
        tbb::simple_partitioner(), apart);
    return;
  }
  std::size_t next = 0;
  const auto number = [&](tbb::flow_control& control) -> std::size_t {
    if (next == count) control.stop();
    return next++;
  };
  tbb::parallel_pipeline(at_once,
                         tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, number) &
                             tbb::make_filter<std::size_t, void>(tbb::filter_mode::parallel, makeOne),
                         apart);
}

void forEachIndex(std::size_t count, const std::string& what, const std::function<void(std::size_t)>& make,
                  std::size_t at_once) {
  SharedProgress progress(what, count);
  forEachIndex(count, progress, make, at_once);
}

}  // namespace fathom
