#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "similarity/measure.h"

namespace fathom {

/// Whether a marker detector behaves alike on both images: what it finds, and where. A marker is found in
/// both where family and id are the same; of several such, the nearest.
struct DetectionAgreementMeasure {
  static constexpr std::string_view id = "detection-agreement";
  static constexpr std::string_view about =
      "markers found in both images over those found in either, and how far apart";
  static constexpr std::array<Quantity, 4> quantities{{{"agreement", "1", Better::higher},
                                                       {"only-recorded", "markers", Better::lower},
                                                       {"only-simulated", "markers", Better::lower},
                                                       {"corner-rms", "px", Better::lower}}};

  static MeasureOutcome measure(const PairView& pair) {
    const auto& recorded = pair->recorded_detections;
    auto unmatched = pair->simulated_detections;
    if (recorded.empty() && unmatched.empty()) return notMeasured("no marker was found in either image");
    double both = 0, squares_px2 = 0;
    for (const Detection& detection : recorded) {
      const auto match = nearestAlike(detection, unmatched);
      if (match == unmatched.end()) continue;
      for (std::size_t k = 0; k < 4; ++k)
        squares_px2 += (match->corners_px[k] - detection.corners_px[k]).squaredNorm();
      both += 1;
      unmatched.erase(match);
    }
    const double only_recorded = static_cast<double>(recorded.size()) - both;
    const auto only_simulated = static_cast<double>(unmatched.size());
    const auto corner_rms_px = both > 0 ? std::optional(std::sqrt(squares_px2 / (4 * both))) : std::nullopt;
    return {{both / (both + only_recorded + only_simulated), only_recorded, only_simulated, corner_rms_px},
            ""};
  }

 private:
  static std::vector<Detection>::iterator nearestAlike(const Detection& sought,
                                                       std::vector<Detection>& among) {
    auto nearest = among.end();
    const auto distance = [&](const Detection& other) {
      return (other.centre_px() - sought.centre_px()).norm();
    };
    for (auto it = among.begin(); it != among.end(); ++it) {
      if (it->family != sought.family || it->id != sought.id) continue;
      if (nearest == among.end() || distance(*it) < distance(*nearest)) nearest = it;
    }
    return nearest;
  }
};

}  // namespace fathom
