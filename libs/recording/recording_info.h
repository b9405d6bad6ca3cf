#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "recording/rawlog.h"

namespace fathom {

/// "INS", "DVL", "DVL beams", "depth", "pose", "image", "stereo image", "comment", or for an entry the
/// convention does not know its MRPT class.
std::string kindOf(const Reading& reading);

struct RecordingGap {
  Time begin;  ///< time of the last entry before it
  double seconds = 0.0;
};

/// What a recording holds under one sensor label.
struct LabelInfo {
  std::string label;
  std::string kind;  ///< see kindOf()
  std::uint64_t count = 0;
  Time first_time{}, last_time{};
  double rate_hz = 0.0;            ///< mean: periods over their sum; 0 with fewer than two different times
  double median_period_s = 0.0;    ///< 0 likewise
  double jitter_s = 0.0;           ///< standard deviation of the periods that are no gaps
  std::vector<RecordingGap> gaps;  ///< periods beyond InspectOptions::gap_periods medians, in time order
  std::uint64_t duplicates = 0;    ///< entries at the very time of the one before
  std::uint64_t steps_back = 0;    ///< entries earlier than the one before
  std::uint64_t without_time = 0;  ///< entries whose time stamp is not set; left out of the above
  std::uint64_t not_finite = 0;    ///< entries with a NaN or infinite value
  std::map<std::string, std::uint64_t> absent;  ///< what is lacking (e.g. "bottom lock") in how many entries
  std::vector<Pose> mountings;                  ///< of the first entry, see mountings()
  std::uint64_t mounting_changes = 0;           ///< entries whose mounting is not the one before
  std::vector<RecordedCamera> intrinsics;       ///< of the first entry
  std::uint64_t intrinsics_changes = 0;
  std::vector<std::string> missing_images;  ///< files not in the image folder
};

struct RecordingInfo {
  std::filesystem::path file;
  std::uint64_t file_bytes = 0;
  RecordingHeader header;
  std::uint64_t entries = 0;
  Time first_time{}, last_time{};
  double duration_s = 0.0;
  std::uint64_t steps_back = 0;   ///< entries earlier than the one before, of whatever label
  std::vector<LabelInfo> labels;  ///< sorted by label, then kind
  std::optional<RecordingLoss> loss;
};

struct InspectOptions {
  double gap_periods = 3.0;  ///< a gap is longer than this many median periods
};

/// Reads a rawlog once. Memory: 16 bytes an entry, for the medians.
/// Throws Error as RawlogReader does; damage is in `loss`.
RecordingInfo inspectRecording(const std::filesystem::path& rawlog, const InspectOptions& options = {},
                               const std::function<void(double)>& progress = {});

/// What deserves attention, one printable line each; empty where all is well.
std::vector<std::string> remarks(const RecordingInfo& info);
/// Text for people, several lines, remarks included.
std::string describe(const RecordingInfo& info);
nlohmann::json toJson(const RecordingInfo& info);

}  // namespace fathom
