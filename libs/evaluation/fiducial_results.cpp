#include "evaluation/fiducial_results.h"

#include <cmath>

#include "core/text.h"

namespace fathom {
namespace {

std::string field(double value) { return std::isfinite(value) ? print(",%.6g", value) : ","; }

FiducialGroups byCondition(const std::vector<FiducialResult>& results) {
  return grouped(results, [](const FiducialResult& r) {
    return FiducialKey{r.image.family, r.reader, r.image.range, r.image.tilt, r.image.water, r.image.blur};
  });
}

constexpr const char* kConditionHeader =
    "family,reader,range_m,tilt_deg,water,attenuation_green_per_m,blur_px,images";

std::string condition(const FiducialGrid& grid, const FiducialKey& key, std::size_t images) {
  const NamedWater& water = grid.waters[key[4]];
  return grid.families[key[0]] + "," + readersOf(grid.backends, grid.preprocessings)[key[1]].name() +
         print(",%.6g,%.6g,", grid.ranges_m[key[2]], degrees(grid.tilts_rad[key[3]])) + water.name +
         print(",%.6g,%.6g,%zu", water.water.attenuation_per_m[1], grid.blurs_px[key[5]], images);
}

}  // namespace

FiducialGroups grouped(const std::vector<FiducialResult>& results,
                       const std::function<FiducialKey(const FiducialResult&)>& keyOf) {
  FiducialGroups groups;
  for (const FiducialResult& result : results) {
    FiducialGroup& group = groups[keyOf(result)];
    group.score.add(result.score);
    group.detect_s += result.detect_s;
  }
  return groups;
}

std::string formatResults(const FiducialGrid& grid, const std::vector<FiducialResult>& results) {
  std::string text = std::string(kConditionHeader) +
                     ",markers_visible,markers_found,detection_rate,detection_rate_low95,"
                     "detection_rate_high95,false_detections,not_on_map,corner_rms_px,poses,"
                     "position_error_median_m,angle_error_median_deg\n";
  for (const auto& [key, group] : byCondition(results)) {
    const ScoreTally& score = group.score;
    const auto [low, high] = score.detectionRate95();
    text += condition(grid, key, score.images()) + print(",%zu,%zu", score.visible(), score.found()) +
            field(score.detectionRate()) +
            print(",%.6g,%.6g,%zu,%zu", low, high, score.wrong(), score.unknown()) +
            field(score.cornerRms_px()) + print(",%zu", score.posed()) +
            field(score.medianPositionError_m()) + field(degrees(score.medianAngleError_rad())) + "\n";
  }
  return text;
}

std::string formatTimes(const FiducialGrid& grid, const std::vector<FiducialResult>& results) {
  std::string text = std::string(kConditionHeader) + ",detect_cpu_ms\n";
  for (const auto& [key, group] : byCondition(results))
    text += condition(grid, key, group.score.images()) + field(group.meanDetect_ms()) + "\n";
  return text;
}

}  // namespace fathom
