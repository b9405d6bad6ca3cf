#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recording/samples.h"

/// What a reading holds, as plain lists, for tables and for checks that treat every kind alike.
namespace fathom {

/// Names of the reading's numbers, frame and unit included.
std::vector<std::string> fieldNames(const Reading& reading);
/// How many rows of such numbers it holds: one, but of panels and markers that are seen as many as there are.
std::size_t fieldRows(const Reading& reading);
/// Their values, row by row in the same order; nothing where the field is absent. Replaces `values`.
void fieldValues(const Reading& reading, std::vector<std::optional<double>>& values);

/// What the entry lacks, in words ("bottom lock"); empty where it is complete.
std::vector<std::string> absentParts(const Reading& reading);
/// T_robot_sensor; for STEREO T_robot_left, T_left_right; for DVL_BEAMS one a beam.
std::vector<Pose> mountings(const Reading& reading);
std::vector<RecordedCamera> intrinsics(const Reading& reading);
std::vector<std::string> imageFiles(const Reading& reading);

}  // namespace fathom
