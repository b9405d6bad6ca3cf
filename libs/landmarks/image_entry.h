#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/camera_model.h"
#include "recording/sample_source.h"
#include "sensors/vehicle.h"

namespace fathom {

/// An image's file and the camera that took it.
struct CameraImage {
  std::filesystem::path file;
  CameraModel camera;
};

/// A recording's entry with an image, or with a pair of them.
struct ImageEntry {
  struct Eye {
    CameraImage image;
    Pose T_first_camera;  ///< this camera on the first one
  };
  Time time;
  Instance instance{};    ///< of the vehicle's cameras
  Pose T_robot_camera;    ///< the first eye's mounting
  std::vector<Eye> eyes;  ///< one; of a pair two, the left one first
  /// As the latest DVL and gyro entries before it say, robot axes; zero where there is none.
  Vector3d velocity_robot = Vector3d::Zero(), angular_velocity_robot = Vector3d::Zero();
};

/// Whether a sample is an image or a pair of them.
bool isImage(const Sample& sample);

/// Nothing where the sample is not an image. Mounting and intrinsics are the entry's own, the Bayer pattern
/// is the vehicle's.
std::optional<ImageEntry> imageEntry(const Sample& sample, const std::filesystem::path& image_folder,
                                     const Vehicle& vehicle);

/// All of a source, in its order. Reads it to its end. Throws as SampleSource::next().
std::vector<ImageEntry> imageEntries(SampleSource& source, const Vehicle& vehicle);

/// Each file once, in their order.
std::vector<CameraImage> imagesOf(const std::vector<ImageEntry>& entries);

}  // namespace fathom
