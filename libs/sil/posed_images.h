#pragma once

#include <string>
#include <vector>

#include "landmarks/landmark_source.h"

/// Where each image of a recording was taken, as its own markers tell: the first half of the paper's
/// Algorithm 1 (markers -> panel pose -> robot pose).
namespace fathom {

/// One image; an entry with a pair gives two.
struct PosedImage {
  Time time;
  std::size_t entry = 0;  ///< among the recording's entries with images
  std::size_t eye = 0;    ///< 0: the only or the left one
  CameraImage image;
  UncertainPose
      T_odom_robot;    ///< by the joint solution of the panel that is known best, its map's pose exact
  Pose T_odom_camera;  ///< of this very eye
  std::vector<Detection> detections;  ///< all that was found in it
};

struct UnposedImage {
  Time time;
  std::filesystem::path file;
  std::string why;  ///< one line: not readable, no marker, ambiguous, …
};

struct PosedImages {
  std::vector<PosedImage> posed;      ///< in the order of the recording
  std::vector<UnposedImage> unposed;  ///< likewise
};

/// `sightings` are those of the entries (solveSightings).
PosedImages posedImages(const std::vector<ImageEntry>& entries, const Detections& detections,
                        const Sightings& sightings, const std::vector<PanelMap>& panels);

}  // namespace fathom
