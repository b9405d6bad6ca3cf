#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fiducials/detection.h"
#include "sensors/vehicle.h"
#include "similarity/fsim.h"

/// What every measure of a recorded and a simulated image is made of. A measure is a plain struct, NAME.h:
///
///   struct SsimMeasure {
///     static constexpr std::string_view id = "ssim";
///     static constexpr std::string_view about = "…";               // one line
///     static constexpr std::array<Quantity, 1> quantities{{{"ssim", "1", Better::higher}}};
///     static MeasureOutcome measure(const PairView& pair);
///   };
///
/// `measure` may be called by several threads at a time, each with a view of its own. The view's images are
/// fit to be compared, see whyNotComparable(); for what else it needs it looks itself, and says what is
/// missing.
namespace fathom {

/// A recorded image, what the simulator made of the same moment, and what is known of both.
struct ImagePair {
  cv::Mat recorded, simulated;          ///< CV_8UC3 (BGR), of one size
  cv::Mat panel_mask;                   ///< CV_8UC1, not 0 where a panel is; empty: not known
  const CameraSheet* camera = nullptr;  ///< of both; null: not known
  std::vector<Detection> recorded_detections, simulated_detections;
};

enum class Better { higher, lower };

/// A number that a measure gives.
struct Quantity {
  std::string_view name, unit;
  Better better;
};

/// The quantities' values in their order, nothing for one that does not apply to this pair; or why nothing
/// could be measured.
struct MeasureOutcome {
  std::vector<std::optional<double>> values;
  std::string why_not;
};

inline MeasureOutcome notMeasured(std::string why) { return {{}, std::move(why)}; }

/// A pair as measures see it: what several of them need is computed once, when the first one asks. For one
/// thread; it refers to the pair and the comparer.
class PairView {
 public:
  PairView(const ImagePair& pair, const FsimComparer& comparer) : pair_(pair), comparer_(comparer) {}

  const ImagePair* operator->() const { return &pair_; }
  /// Nothing where neither image has any feature.
  const std::optional<FsimScore>& fsim() const {
    if (!fsim_) fsim_ = comparer_.compare(pair_.recorded, pair_.simulated);
    return *fsim_;
  }

 private:
  const ImagePair& pair_;
  const FsimComparer& comparer_;
  mutable std::optional<std::optional<FsimScore>> fsim_;
};

}  // namespace fathom
