#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "landmarks/detection_cache.h"
#include "sil/posed_images.h"
#include "sil/sil_world.h"
#include "similarity/measure.h"

/// The second half of the paper's Algorithm 1: render at the robot's pose -> pair <real, simulated>.
namespace fathom {

struct PairOptions {
  /// The simulated image has the sensor's shot and read noise, as the recorded one has: like with like.
  bool noise = true;
  std::uint64_t seed = 1;  ///< of that noise
  /// A pose belongs to an image where, at that pose, half of the image's own markers are no farther from
  /// where they should be (root mean square over their corners).
  double largest_offset_px = 10;
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

/// A recorded image, and what its camera would have seen without water from where the pose says it was.
struct CleanPair {
  cv::Mat recorded;    ///< CV_8UC3 (BGR)
  View clean;          ///< under full ambient light, lamps off: its radiance is the albedo
  cv::Mat panel_mask;  ///< CV_8UC1, not 0 where a panel is
};

/// Makes pairs, for many threads at once. A pair depends on nothing but world, options and the posed image,
/// which must have been posed with the world's effects.
class PairMaker {
 public:
  /// Throws std::invalid_argument where the vehicle has no camera or there is no panel.
  PairMaker(SilWorld world, const PairOptions& options, DetectionSettings detection);

  const SilWorld& world() const { return world_; }
  const CameraSheet& camera() const { return *world_.vehicle.camera; }
  /// Of the world, with its effects.
  const CameraStudio& studio() const { return studio_; }

  /// Throws Error{file, "", why} where there is no pair: the image cannot be read or is not of its camera's
  /// size, the pose is not its own, no panel is in view, one of the images is saturated.
  SilPair make(const PosedImage& posed) const;
  /// Without water, noise and search for markers; throws likewise, but not for saturated images.
  CleanPair clean(const PosedImage& posed) const;

  /// What is compared. Where the sea floor is known, all of the picture; otherwise only the panels: around
  /// them the recorded image is replaced by the simulated one, so that nothing else can differ there.
  ImagePair compared(const ImagePair& images) const;
  /// The pixels of that, CV_8UC1.
  cv::Mat comparedRegion(const ImagePair& images) const;

 private:
  using Detectors = tbb::enumerable_thread_specific<std::map<std::string, std::unique_ptr<Detector>>>;

  Detector& detectorOf(const CameraModel& camera) const;
  cv::Mat panelMask(const PosedImage& posed, const View& view) const;
  void requireOwnPose(const PosedImage& posed) const;

  SilWorld world_;
  PairOptions options_;
  DetectionSettings detection_;
  CameraStudio studio_;
  mutable Detectors detectors_;
};

/// As measures want it: CV_8UC3, whatever the file's channels.
cv::Mat inColour(const cv::Mat& image);

}  // namespace fathom
