#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "evaluation/fiducial_comparison.h"

namespace fathom {

/// Results put together.
struct FiducialGroup {
  ScoreTally score;
  double detect_s = 0;  ///< sum

  double meanDetect_ms() const { return 1e3 * detect_s / static_cast<double>(score.images()); }
};

/// By whatever key a result is given: {family, reader}, {family, reader, range} …
using FiducialKey = std::vector<std::size_t>;
using FiducialGroups = std::map<FiducialKey, FiducialGroup>;
FiducialGroups grouped(const std::vector<FiducialResult>& results,
                       const std::function<FiducialKey(const FiducialResult&)>& keyOf);

/// CSV, one line a family, reader, range, tilt, water and blur, over the repeats. Empty fields where there is
/// nothing to tell. The same grid gives the same bytes.
std::string formatResults(const FiducialGrid& grid, const std::vector<FiducialResult>& results);
/// The same lines with the mean CPU time of detection, which is measured.
std::string formatTimes(const FiducialGrid& grid, const std::vector<FiducialResult>& results);

}  // namespace fathom
