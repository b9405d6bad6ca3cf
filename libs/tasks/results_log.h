#pragma once

#include <deque>
#include <filesystem>
#include <vector>

#include "recording/rawlog.h"

namespace fathom {

/// NAME_results.rawlog: what several tasks and the landmarks give, in time order.
class ResultsLog {
 public:
  /// `streams` deliver side by side, each in time order and from one thread at a time. Throws Error.
  ResultsLog(const std::filesystem::path& file, const RecordingHeader& header, Time time_zero,
             std::size_t streams);

  void add(std::size_t stream, Sample sample) { pending_[stream].push_back(std::move(sample)); }
  /// Writes what is older than `time`. Not while a stream delivers. What of such comes all the same (a
  /// recording's stamps step back) is left out.
  void writeBefore(const Time& time);
  /// Writes the rest and puts the file under its name. Throws Error.
  void finish();

 private:
  RawlogWriter rawlog_;
  Time written_;  ///< up to there
  std::vector<std::deque<Sample>> pending_;
};

}  // namespace fathom
