#include "localization/run_tasks.h"

#include "core/parallel.h"

namespace fathom {
namespace {

constexpr std::size_t kBlock = 4096;  // samples: under a minute of a usual recording

std::vector<Sample> readBlock(SampleSource& source) {
  std::vector<Sample> block;
  block.reserve(kBlock);
  while (block.size() < kBlock) {
    auto sample = source.next();
    if (!sample) break;
    block.push_back(std::move(*sample));
  }
  return block;
}

}  // namespace

std::vector<LocalizationSummary> runTasks(SampleSource& source, const std::vector<Localizer*>& tasks,
                                          Time time_zero, const TaskHooks& hooks) {
  double newest_t_s = 0.0;
  std::vector<Sample> block = readBlock(source);
  while (!block.empty()) {
    for (const Sample& sample : block) {
      hooks.sample(sample);
      newest_t_s = std::max(newest_t_s, secondsBetween(time_zero, sample.time));
    }
    std::vector<Sample> next;
    bothAtOnce([&] { next = readBlock(source); },
               [&] {
                 parallelFor(tasks.size(), [&](std::size_t i) {
                   for (const Sample& sample : block) tasks[i]->add(sample);
                 });
               });
    hooks.block(newest_t_s);
    block = std::move(next);
  }
  std::vector<LocalizationSummary> summaries(tasks.size());
  parallelFor(tasks.size(), [&](std::size_t i) { summaries[i] = tasks[i]->finish(); });
  return summaries;
}

}  // namespace fathom
