#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/time.h"

/// When each frame of a video was taken, from a table beside it.
namespace fathom {

struct FrameStamp {
  std::int64_t frame = 0;  ///< of the video, from 0 on
  Time time;
  std::size_t line = 0;  ///< of the table, from 1 on
};

struct StampTable {
  std::filesystem::path file;
  std::vector<FrameStamp> stamps;    ///< at least one; frames and times increase
  bool names_frames = false;         ///< a column says which frame; else each frame has its row
  std::vector<std::string> remarks;  ///< what was concluded from the values, one line each

  /// An Error at a stamp's line.
  Error error(const FrameStamp& stamp, const std::string& why) const;
};

/// Reads a table of stamps, CSV, gzip or plain: one stamp a row, in the order of frames, or frame and stamp.
/// The columns' names in the first line (`stamp`; `frame` and `stamp`, in any order) may be left out: the
/// frame then comes first. Frames count from 0, or from 1 where the first row's is 1.
///
/// Stamps are UTC: Unix time in s, ms, us or ns, which their size tells (1990 to 2100), or ISO 8601, basic or
/// extended, without a zone taken for UTC; all rows in the same form. Rounded to the 100 ns of rawlogs.
///
/// Throws Error with file and line: cannot be read, another number of columns, no stamp, a stamp in another
/// form than the rows before, a frame or a stamp that does not increase.
StampTable readFrameStamps(const std::filesystem::path& file);

/// "2024-05-06T07:08:09.25+02:00", "20240506T070809Z", with a blank for the T, too. Nothing where it is not
/// like that, or no such time exists. A leap second is the first of the next minute.
struct IsoStamp {
  Time time;
  bool has_zone = false;  ///< taken for UTC without
};
std::optional<IsoStamp> readIsoStamp(std::string_view text);

/// How regular stamps are, and how many frames are missing between them: a line each. `header_rate_hz`: as
/// the video says it; 0 where it does not.
std::vector<std::string> describePace(const std::vector<FrameStamp>& stamps, double header_rate_hz);

}  // namespace fathom
