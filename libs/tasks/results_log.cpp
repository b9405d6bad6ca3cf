#include "tasks/results_log.h"

#include <algorithm>

namespace fathom {

ResultsLog::ResultsLog(const std::filesystem::path& file, const RecordingHeader& header, Time time_zero,
                       std::size_t streams)
    : rawlog_(file, header, time_zero), written_(time_zero), pending_(streams) {}

void ResultsLog::writeBefore(const Time& time) {
  for (;;) {
    std::deque<Sample>* earliest = nullptr;
    for (auto& stream : pending_)
      if (!stream.empty() && stream.front().time < time &&
          (earliest == nullptr || stream.front().time < earliest->front().time))
        earliest = &stream;
    if (earliest == nullptr) return;
    if (const Sample& sample = earliest->front(); sample.time >= written_) {
      rawlog_.write(sample);
      written_ = sample.time;
    }
    earliest->pop_front();
  }
}

void ResultsLog::finish() {
  writeBefore(Time::max());
  rawlog_.finish();
}

}  // namespace fathom
