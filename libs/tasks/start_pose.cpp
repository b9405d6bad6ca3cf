#include "tasks/start_pose.h"

#include <charconv>
#include <cmath>
#include <sstream>

#include "core/error.h"
#include "core/text.h"
#include "recording/rawlog.h"
#include "recording/tum.h"
#include "tasks/reference_clock.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// The first TRUTH entry; the estimator itself never sees one.
std::optional<StampedPose> firstTruth(const fs::path& rawlog) {
  RawlogReader reader(rawlog);
  while (const auto sample = reader.next())
    if (sample->label == labels::kTruth)
      if (const auto* pose = std::get_if<PoseSample>(&sample->reading))
        return StampedPose{sample->time, pose->T_odom_robot.mean};
  return std::nullopt;
}

/// The first reading's time: where estimation begins.
Time firstReading(const fs::path& rawlog) {
  RawlogReader reader(rawlog);
  while (const auto sample = reader.next())
    if (!std::holds_alternative<RecordingHeader>(sample->reading)) return sample->time;
  throw Error(rawlog.string(), "", "holds no reading");
}

/// Just before the reference begins: what it does as long after, backwards; at most its first step.
std::optional<Pose> poseBefore(const std::vector<StampedPose>& reference, const Time& time) {
  const StampedPose& first = reference.front();
  const Time as_long_after = first.time + (first.time - time);
  if (reference.size() < 2 || time > first.time || as_long_after > reference[1].time) return std::nullopt;
  const Pose& at_first = first.T_odom_robot;
  const auto later = poseAt(reference, as_long_after);
  if (!later) return std::nullopt;
  return Pose{at_first.rotation * later->rotation.transpose() * at_first.rotation,
              2.0 * at_first.position - later->position};
}

StartPose startFromReference(const fs::path& rawlog, const std::vector<StampedPose>& reference) {
  const Time begin = firstReading(rawlog);
  if (!reference.empty()) {
    const double offset_s = referenceClockOffset(rawlog, reference).value_or(0.0);
    const Time there = after(begin, offset_s);
    const std::string clock =
        offset_s == 0.0 ? "" : print(", %+.2f s from its stamp: so it turns as the gyro does", offset_s);
    if (const auto pose = poseAt(reference, there))
      return StartPose{.T_odom_robot = *pose, .source = "first pose of the reference" + clock};
    if (const auto pose = poseBefore(reference, there))
      return StartPose{.T_odom_robot = *pose,
                       .source = "just before the first pose of the reference" + clock};
    throw Error("--start", "reference", "the reference has no pose at the recording's first reading");
  }
  const auto truth = firstTruth(rawlog);
  if (!truth)
    throw Error("--start", "reference",
                "there is no reference: neither --reference nor TRUTH in the recording");
  if (std::abs(secondsBetween(begin, truth->time)) > 0.1)
    throw Error("--start", "reference", "the first TRUTH entry is not at the recording's first reading");
  return StartPose{.T_odom_robot = truth->T_odom_robot, .source = "first TRUTH entry"};
}

StartPose startFromNumbers(const std::string& text) {
  std::vector<double> v;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    double value = 0.0;
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (problem != std::errc{} || end != word.data() + word.size() || !std::isfinite(value))
      throw Error("--start", text, "must be auto, reference or X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]");
    v.push_back(value);
  }
  if (v.size() != 4 && v.size() != 6)
    throw Error("--start", text, "must have four or six numbers: X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]");
  v.resize(6, 0.0);
  return {.T_odom_robot = {rotationFromYawPitchRoll(radians(v[3]), radians(v[4]), radians(v[5])),
                           Vector3d(v[0], v[1], v[2])},
          .source = "given on the command line"};
}

}  // namespace

std::optional<StartPose> startPose(const std::string& start, const fs::path& rawlog,
                                   const std::vector<StampedPose>& reference) {
  if (start == "auto") return std::nullopt;
  if (start == "reference") return startFromReference(rawlog, reference);
  return startFromNumbers(start);
}

}  // namespace fathom
