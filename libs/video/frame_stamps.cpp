#include "video/frame_stamps.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>

#include "core/median.h"
#include "core/text.h"
#include "recording/csv.h"
#include "recording/time_text.h"

namespace fathom {
namespace {

// A double resolves 0.24 us of today's Unix time, and worse of nanoseconds.
using Number = long double;
constexpr Number kTicksPerSecond = 1e7L;
constexpr Number kEarliest_s = 631'152'000.0L, kLatest_s = 4'102'444'800.0L;  // 1990 and 2100

struct StampUnit {
  const char* name;
  Number per_second;
};
// What is between 1990 and 2100 in one of them is in none of the others.
constexpr StampUnit kStampUnits[] = {
    {"seconds", 1}, {"milliseconds", 1e3L}, {"microseconds", 1e6L}, {"nanoseconds", 1e9L}};

const StampUnit* unitOf(Number stamp) {
  for (const StampUnit& unit : kStampUnits)
    if (stamp >= kEarliest_s * unit.per_second && stamp <= kLatest_s * unit.per_second) return &unit;
  return nullptr;
}

Time timeOf(Number stamp, const StampUnit& unit) {
  return fromUnixTicks(std::llround(stamp * (kTicksPerSecond / unit.per_second)));
}

template <class T>
std::optional<T> wholly(std::string_view text) {
  T value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

std::optional<Number> finiteStamp(std::string_view text) {
  const auto value = wholly<Number>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Without blanks and quotes around it.
std::string_view bare(std::string_view field) {
  constexpr std::string_view kAround = " \t\"";
  const auto first = field.find_first_not_of(kAround);
  if (first == std::string_view::npos) return {};
  return field.substr(first, field.find_last_not_of(kAround) - first + 1);
}

/// A text from left to right.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : rest_(text) {}

  bool take(char c) {
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool takeAny(std::string_view of) {
    return std::any_of(of.begin(), of.end(), [this](char c) { return take(c); });
  }
  /// Exactly so many of them; -1 where they are not there.
  int digits(std::size_t count) {
    if (rest_.size() < count) return -1;
    int value = 0;
    for (const char c : rest_.substr(0, count)) {
      if (c < '0' || c > '9') return -1;
      value = 10 * value + (c - '0');
    }
    rest_.remove_prefix(count);
    return value;
  }
  bool atEnd() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

/// What follows the point of a second, in ticks.
std::optional<std::int64_t> fractionIn(TextCursor& at) {
  int digit = at.digits(1);
  if (digit < 0) return {};
  std::int64_t ticks = 0, unit = static_cast<std::int64_t>(kTicksPerSecond);
  for (bool rounded = false; digit >= 0; digit = at.digits(1)) {
    unit /= 10;
    ticks += digit * unit;
    if (unit == 0 && !rounded && digit >= 5) ++ticks;
    rounded = unit == 0;
  }
  return ticks;
}

/// "Z", "+02:00", "+0200", "+02": what local time is ahead of UTC.
std::optional<std::chrono::minutes> zoneIn(TextCursor& at) {
  if (at.takeAny("Zz")) return std::chrono::minutes(0);
  const int sign = at.take('-') ? -1 : 1;
  if (sign > 0 && !at.take('+')) return {};
  const int hours = at.digits(2);
  const bool has_minutes = at.take(':') || !at.atEnd();
  const int minutes = has_minutes ? at.digits(2) : 0;
  if (hours < 0 || hours > 23 || minutes < 0 || minutes > 59) return {};
  return std::chrono::minutes(sign * (60 * hours + minutes));
}

struct StampColumns {
  bool header = false;
  std::optional<std::size_t> frame;
  std::size_t stamp = 0;
};

/// "frame", "frame_number", "Frame".
bool namesFrame(std::string_view column) {
  constexpr std::string_view kFrame = "frame";
  return column.size() >= kFrame.size() &&
         std::equal(kFrame.begin(), kFrame.end(), column.begin(),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

/// Neither numbers nor dates begin with a letter.
bool isColumnName(std::string_view field) {
  return !field.empty() && (std::isalpha(static_cast<unsigned char>(field[0])) != 0 || field[0] == '_');
}

StampColumns columnsOf(const std::filesystem::path& file, const std::vector<std::string>& first_line) {
  const Error unknown(file.string(), "line 1", "must have a stamp, or frame,stamp, or these columns' names");
  if (first_line.size() > 2) throw unknown;
  std::vector<std::string_view> names;
  for (const std::string& field : first_line) {
    std::string_view name = bare(field);
    if (name.starts_with('#')) name = bare(name.substr(1));  // as numpy begins a header
    names.push_back(name);
  }
  StampColumns columns;
  columns.header = std::all_of(names.begin(), names.end(), isColumnName);
  if (names.size() == 1) return columns;
  columns.frame = 0;
  columns.stamp = 1;
  if (!columns.header) return columns;
  if (namesFrame(names[0]) == namesFrame(names[1])) throw unknown;
  if (namesFrame(names[1])) columns = {true, 1, 0};
  return columns;
}

/// Rows of one table, in one form.
class StampReader {
 public:
  StampReader(StampTable& table, StampColumns columns) : table_(table), columns_(columns) {
    table_.names_frames = columns.frame.has_value();
  }

  void add(const std::vector<std::string>& fields, std::size_t line) {
    FrameStamp stamp{std::ssize(table_.stamps), {}, line};
    if (columns_.frame) stamp.frame = frameOf(bare(fields[*columns_.frame]), stamp);
    stamp.time = timeIn(bare(fields[columns_.stamp]), stamp);
    if (!table_.stamps.empty()) refuseNoIncrease(stamp, table_.stamps.back());
    table_.stamps.push_back(stamp);
  }

  std::vector<std::string> remarks() const {
    std::string form = "ISO 8601";
    if (unit_)
      form = std::string("Unix time in ") + unit_->name + ", by their size";
    else if (!*has_zone_)
      form += ", taken for UTC: they name no zone";
    std::vector<std::string> lines{"the stamps are " + form};
    if (columns_.frame) lines.push_back(print("frames are counted from %d, by the first row", first_frame_));
    return lines;
  }

 private:
  std::int64_t frameOf(std::string_view text, const FrameStamp& row) {
    const auto frame = wholly<std::int64_t>(text);
    if (!frame || *frame < 0)
      throw table_.error(row, "frame must be a whole number from 0 on: `" + std::string(text) + "`");
    if (table_.stamps.empty()) first_frame_ = *frame == 1 ? 1 : 0;
    return *frame - first_frame_;
  }

  Time timeIn(std::string_view text, const FrameStamp& row) {
    const std::string quoted = "`" + std::string(text) + "`";
    const bool first = table_.stamps.empty();
    if (const auto number = finiteStamp(text)) {
      const StampUnit* unit = unitOf(*number);
      if (!unit) throw table_.error(row, "is no Unix time from 1990 to 2100, in s, ms, us or ns: " + quoted);
      if (!first && unit != unit_)
        throw table_.error(row, "stamp of another form than those before: " + quoted);
      unit_ = unit;
      return timeOf(*number, *unit);
    }
    const auto iso = readIsoStamp(text);
    if (!iso) throw table_.error(row, "neither Unix time nor ISO 8601: " + quoted);
    if (!first && has_zone_ != iso->has_zone)
      throw table_.error(row, "stamp of another form than those before: " + quoted);
    has_zone_ = iso->has_zone;
    return iso->time;
  }

  void refuseNoIncrease(const FrameStamp& stamp, const FrameStamp& before) const {
    if (stamp.frame <= before.frame) throw table_.error(stamp, "frame is not above that of the row before");
    const double step_s = secondsBetween(before.time, stamp.time);
    if (step_s == 0) throw table_.error(stamp, "its stamp is that of the row before again");
    if (step_s < 0) throw table_.error(stamp, print("its stamp steps back by %.7g s", -step_s));
  }

  StampTable& table_;
  StampColumns columns_;
  int first_frame_ = 0;
  const StampUnit* unit_ = nullptr;  ///< none: ISO 8601
  std::optional<bool> has_zone_;     ///< of ISO 8601
};

}  // namespace

Error StampTable::error(const FrameStamp& stamp, const std::string& why) const {
  return {file.string(), print("line %zu", stamp.line), why};
}

std::optional<IsoStamp> readIsoStamp(std::string_view text) {
  using namespace std::chrono;
  TextCursor at(text);
  const int y = at.digits(4);
  const bool extended_date = at.take('-');
  const int m = at.digits(2);
  if (extended_date && !at.take('-')) return {};
  const int d = at.digits(2);
  if (y < 0 || m < 0 || d < 0 || !at.takeAny("Tt ")) return {};
  const int hour = at.digits(2);
  const bool extended_time = at.take(':');
  const int minute = at.digits(2);
  if (extended_time && !at.take(':')) return {};
  const int second = at.digits(2);
  const auto date = year(y) / month(static_cast<unsigned>(m)) / day(static_cast<unsigned>(d));
  const bool exists =
      date.ok() && hour >= 0 && hour < 24 && minute >= 0 && minute < 60 && second >= 0 && second <= 60;
  if (!exists) return {};
  std::int64_t fraction_ticks = 0;
  if (at.take('.')) {
    const auto fraction = fractionIn(at);
    if (!fraction) return {};
    fraction_ticks = *fraction;
  }
  IsoStamp stamp;
  minutes ahead{0};
  stamp.has_zone = !at.atEnd();
  if (stamp.has_zone) {
    const auto zone = zoneIn(at);
    if (!zone || !at.atEnd()) return {};
    ahead = *zone;
  }
  const seconds whole =
      sys_days(date).time_since_epoch() + hours(hour) + minutes(minute) + seconds(second) - ahead;
  stamp.time = fromUnixTicks(Time::duration(whole).count() + fraction_ticks);
  return stamp;
}

StampTable readFrameStamps(const std::filesystem::path& file) {
  const auto lines = readLines(file);
  StampTable table{file, {}, false, {}};
  const StampColumns columns = columnsOf(file, lines.front());
  StampReader reader(table, columns);
  for (std::size_t k = columns.header ? 1 : 0; k < lines.size(); ++k) reader.add(lines[k], k + 1);
  if (table.stamps.empty()) throw Error(file.string(), "line 2", "has no rows");
  table.remarks = reader.remarks();
  return table;
}

std::vector<std::string> describePace(const std::vector<FrameStamp>& stamps, double header_rate_hz) {
  if (stamps.size() < 2) return {};
  std::vector<double> intervals_s, steps;
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    steps.push_back(static_cast<double>(stamps[k].frame - stamps[k - 1].frame));
    intervals_s.push_back(secondsBetween(stamps[k - 1].time, stamps[k].time) / steps.back());
  }
  const double usual_s = upperMedian(intervals_s);
  std::vector<double> off_s;
  double missing = 0;
  std::size_t gaps = 0;
  for (std::size_t k = 0; k < intervals_s.size(); ++k) {
    off_s.push_back(std::abs(intervals_s[k] - usual_s));
    if (intervals_s[k] < 1.5 * usual_s) continue;
    ++gaps;
    missing += std::round((intervals_s[k] / usual_s - 1) * steps[k]);
  }
  const auto [shortest, longest] = std::minmax_element(intervals_s.begin(), intervals_s.end());
  std::vector<std::string> lines{print(
      "by its stamps a frame each %.6g s (%.5g a second; sigma %.2g s, shortest %.4g s, longest %.4g s)",
      usual_s, 1 / usual_s, sigmaByMedian(off_s), *shortest, *longest)};
  if (gaps > 0)
    lines.push_back(print("%zu intervals are 1.5 times the usual one or more: about %.0f frames were dropped",
                          gaps, missing));
  constexpr double kSameRate = 0.01;
  if (header_rate_hz > 0 && std::abs(header_rate_hz * usual_s - 1) > kSameRate)
    lines.push_back(
        print("its header says %.5g frames a second, its stamps %.5g", header_rate_hz, 1 / usual_s));
  return lines;
}

}  // namespace fathom
