#pragma once

#include <opencv2/core.hpp>

#include "observables/known_world.h"
#include "observables/posed_images.h"
#include "simulation/camera_studio.h"

/// Recorded images beside their renderings: what is compared is cut out of both.
namespace fathom {

/// A recorded image, and what its camera would have seen without water from where the pose says it was.
struct CleanPair {
  cv::Mat recorded;    ///< CV_8UC3 (BGR)
  View clean;          ///< under full ambient light, lamps off: its radiance is the albedo
  cv::Mat panel_mask;  ///< CV_8UC1, not 0 where a panel is
};

/// Makes them, for many threads at once. A pair depends on nothing but the world and the posed image, which
/// must have been posed with the world's effects.
class CleanPairMaker {
 public:
  /// A pose belongs to an image where, at that pose, half of the image's own markers are no farther from
  /// where they should be (root mean square over their corners).
  static constexpr double kLargestOffset_px = 10;

  /// Throws std::invalid_argument where the vehicle has no camera or there is no panel.
  explicit CleanPairMaker(KnownWorld world, double largest_offset_px = kLargestOffset_px);

  const KnownWorld& world() const { return world_; }
  const CameraSheet& camera() const { return *world_.vehicle.camera; }
  /// Of the world, with its effects.
  const CameraStudio& studio() const { return studio_; }

  /// A recorded image in the 8 bits that pairs have, full scale to full scale: gray or BGR. Throws Error as
  /// readImage().
  cv::Mat readRecorded(const std::filesystem::path& file, const CameraModel& taken_by) const;

  /// Throws Error{file, "", why} where there is no pair: the image cannot be read or is not of its camera's
  /// size, the pose is not its own, no panel is in view.
  CleanPair clean(const PosedImage& posed) const;

 protected:
  cv::Mat panelMask(const PosedImage& posed, const View& view) const;
  void requireOwnPose(const PosedImage& posed) const;

 private:
  int recorded_bits_;  ///< as the vehicle's sheet has them
  KnownWorld world_;
  double largest_offset_px_;
  CameraStudio studio_;
};

/// As measures want it: CV_8UC3, whatever the file's channels.
cv::Mat inColour(const cv::Mat& image);

}  // namespace fathom
