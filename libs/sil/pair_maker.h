#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "landmarks/detection_cache.h"
#include "observables/clean_pair.h"
#include "similarity/measure.h"

/// The second half of the paper's Algorithm 1: render at the robot's pose -> pair <real, simulated>.
namespace fathom {

struct PairOptions {
  /// The simulated image has the sensor's shot and read noise, as the recorded one has: like with like.
  bool noise = true;
  std::uint64_t seed = 1;  ///< of that noise
  double largest_offset_px = CleanPairMaker::kLargestOffset_px;
};

/// A recorded image and the one simulated from where it was taken. Both are of 8 bits, as recordings have
/// them; of a gray image, the simulated one is gray too (three equal channels), of a JPEG image it has been
/// through JPEG of the same quality.
struct SilPair {
  ImagePair images;           ///< its camera is the maker's
  double range_m = 0;         ///< camera to the centre of the panel that told the pose
  double view_angle_rad = 0;  ///< between that panel's normal and the line from its centre to the camera
  double panel_share = 0;     ///< of the image's pixels
};

/// Makes pairs, for many threads at once. A pair depends on nothing but world, options and the posed image,
/// which must have been posed with the world's effects.
class PairMaker : public CleanPairMaker {
 public:
  /// Throws std::invalid_argument where the vehicle has no camera or there is no panel.
  PairMaker(KnownWorld world, const PairOptions& options, DetectionSettings detection);

  /// Throws Error{file, "", why} where there is no pair: there is no clean one, or one of the images is
  /// saturated.
  SilPair make(const PosedImage& posed) const;

  /// What is compared. Where the sea floor is known, all of the picture; otherwise only the panels: around
  /// them the recorded image is replaced by the simulated one, so that nothing else can differ there.
  ImagePair compared(const ImagePair& images) const;
  /// The pixels of that, CV_8UC1.
  cv::Mat comparedRegion(const ImagePair& images) const;

 private:
  using Detectors = tbb::enumerable_thread_specific<std::map<std::string, std::unique_ptr<Detector>>>;

  Detector& detectorOf(const CameraModel& camera) const;

  PairOptions options_;
  DetectionSettings detection_;
  mutable Detectors detectors_;
};

}  // namespace fathom
