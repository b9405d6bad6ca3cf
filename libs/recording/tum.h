#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <vector>

#include "core/geometry.h"
#include "core/time.h"

namespace fathom {

struct StampedPose {
  Time time;
  Pose T_odom_robot;
};

/// A path at a time between two of its poses (linear, rotations geodesic); nothing outside, or in its gaps.
std::optional<Pose> poseAt(const std::vector<StampedPose>& path, const Time& time);

/// Whether TUM text can hold a pose after another one (nullptr: it is the first), so that it can be read
/// again: finite, at a time from 1970 to 2477 that is later than the other's.
bool fitsTum(const StampedPose& pose, const StampedPose* before);

/// Reads TUM text (`timestamp tx ty tz qx qy qz qw`, seconds since the epoch; # starts a comment; a mark of
/// UTF-8 at its beginning is skipped).
/// Throws Error (file, line, reason): a line longer than 4 kB, wrong number of fields, not a number, not
/// finite, quaternion not of unit norm (tolerance 1e-3; it is normalized), times not increasing, no pose at
/// all.
std::vector<StampedPose> readTum(const std::filesystem::path& file);

/// One line of TUM text, 100 ns and 1e-9 m resolution.
void writeTumLine(std::ostream& out, const StampedPose& pose);
void writeTum(const std::filesystem::path& file, const std::vector<StampedPose>& poses);

}  // namespace fathom
