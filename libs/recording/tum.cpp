#include "recording/tum.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/files.h"
#include "core/kinematics.h"
#include "core/text.h"
#include "recording/time_text.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kFields = 8;
constexpr double kUnitTolerance = 1e-3;
constexpr long double kLatestSecond = 16e9L;  // about the year 2477
constexpr std::size_t kLongestLine = 4096;
constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

bool isTumTime(long double unix_s) { return unix_s >= 0 && unix_s <= kLatestSecond; }

std::vector<std::string_view> splitAtBlanks(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<std::string_view> words;
  for (auto begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const auto end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return words;
}

/// One line's pose. Throws the reason as text.
struct Flaw {
  std::string why;
};

/// long double: seconds since 1970 to 100 ns need 54 bits.
long double parseNumber(std::string_view word) {
  long double value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc{} || end != word.data() + word.size())
    throw Flaw{"`" + std::string(word) + "` is not a number"};
  if (!std::isfinite(value)) throw Flaw{"`" + std::string(word) + "` is not finite"};
  return value;
}

StampedPose parsePose(const std::vector<std::string_view>& words) {
  if (words.size() != kFields)
    throw Flaw{"has " + std::to_string(words.size()) + " fields, must have 8: time tx ty tz qx qy qz qw"};
  const long double seconds = parseNumber(words[0]);
  if (!isTumTime(seconds)) throw Flaw{"time is not within 1970 to 2477"};
  std::array<double, kFields> v{};
  for (std::size_t i = 1; i < kFields; ++i) v[i] = static_cast<double>(parseNumber(words[i]));
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  if (std::abs(q.norm() - 1.0) > kUnitTolerance) throw Flaw{"the quaternion is not of unit norm"};
  return {fromUnixTicks(std::llroundl(seconds * 1e7L)),
          {q.normalized().toRotationMatrix(), Vector3d(v[1], v[2], v[3])}};
}

/// The next line without its end, of a file of any kind; false at the end. Throws the reason as text.
bool nextLine(std::istream& in, std::string& line) {
  line.resize(kLongestLine);
  in.getline(line.data(), static_cast<std::streamsize>(line.size()));
  const auto read = static_cast<std::size_t>(in.gcount());
  if (in.fail() && read + 1 == line.size()) throw Flaw{"is longer than 4 kB"};
  line.resize(in.eof() || read == 0 ? read : read - 1);  // the line's end is counted, not stored
  return !in.fail();
}

/// The usual interval of a path's poses around one of them: the median of some.
double usualInterval_s(const std::vector<StampedPose>& path, std::ptrdiff_t at) {
  constexpr std::ptrdiff_t kAround = 10;
  const auto begin = std::max<std::ptrdiff_t>(1, at - kAround),
             end = std::min(std::ssize(path), at + kAround + 1);
  std::vector<double> intervals_s;
  for (auto i = begin; i < end; ++i) {
    const auto place = static_cast<std::size_t>(i);
    intervals_s.push_back(secondsBetween(path[place - 1].time, path[place].time));
  }
  const auto middle = intervals_s.begin() + std::ssize(intervals_s) / 2;
  std::nth_element(intervals_s.begin(), middle, intervals_s.end());
  return *middle;
}

/// Whether the path between a pose and the one before is not known: what moves in between is not straight.
bool isGap(const std::vector<StampedPose>& path, std::ptrdiff_t at) {
  constexpr double kShortest_s = 1, kIntervals = 5;
  const auto place = static_cast<std::size_t>(at);
  const double interval_s = secondsBetween(path[place - 1].time, path[place].time);
  return interval_s > kShortest_s && interval_s > kIntervals * usualInterval_s(path, at);
}

}  // namespace

bool fitsTum(const StampedPose& pose, const StampedPose* before) {
  return isTumTime(1e-7L * static_cast<long double>(unixTicks(pose.time))) &&
         pose.T_odom_robot.position.allFinite() && pose.T_odom_robot.rotation.allFinite() &&
         (before == nullptr || before->time < pose.time);
}

std::optional<Pose> poseAt(const std::vector<StampedPose>& path, const Time& time) {
  const auto next = std::lower_bound(path.begin(), path.end(), time,
                                     [](const StampedPose& pose, const Time& t) { return pose.time < t; });
  if (next == path.end()) return std::nullopt;
  if (next->time == time) return next->T_odom_robot;
  if (next == path.begin() || isGap(path, next - path.begin())) return std::nullopt;
  const StampedPose& before = *std::prev(next);
  const double share = secondsBetween(before.time, time) / secondsBetween(before.time, next->time);
  const Pose &a = before.T_odom_robot, &b = next->T_odom_robot;
  const Vector3d turn = logSO3<double>(a.rotation.transpose() * b.rotation);
  return Pose{a.rotation * expSO3<double>(share * turn), a.position + share * (b.position - a.position)};
}

std::vector<StampedPose> readTum(const fs::path& file) {
  std::ifstream in(file);
  if (!in || isFolder(file)) throw Error(file.string(), "", "cannot be read");
  std::vector<StampedPose> poses;
  std::string line;
  int number = 1;
  try {
    for (; nextLine(in, line); ++number) {
      if (number == 1 && line.starts_with(kUtf8Mark)) line.erase(0, kUtf8Mark.size());
      const auto words = splitAtBlanks(std::string_view(line).substr(0, line.find('#')));
      if (words.empty()) continue;
      const StampedPose pose = parsePose(words);
      if (!poses.empty() && pose.time <= poses.back().time) throw Flaw{"time does not increase"};
      poses.push_back(pose);
    }
  } catch (const Flaw& flaw) {
    throw Error(file.string(), "line " + std::to_string(number), flaw.why);
  }
  if (poses.empty()) throw Error(file.string(), "", "holds no pose");
  return poses;
}

void writeTumLine(std::ostream& out, const StampedPose& pose) {
  const Vector3d& t = pose.T_odom_robot.position;
  const Eigen::Quaterniond q(pose.T_odom_robot.rotation);
  out << secondsText(unixTicks(pose.time))
      << print(" %.9f %.9f %.9f %.12f %.12f %.12f %.12f\n", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

void writeTum(const fs::path& file, const std::vector<StampedPose>& poses) {
  std::ostringstream text;
  text << "# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : poses) writeTumLine(text, pose);
  writeTextFile(file, text.str());
}

}  // namespace fathom
