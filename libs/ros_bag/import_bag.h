#pragma once

#include <filesystem>
#include <functional>

#include "recording/imported.h"
#include "ros_bag/topic_map.h"

/// ROS 1 bags.
namespace fathom {

struct BagOptions {
  /// Messages lie in a bag in the order of their arrival; entries are put in the order of their header stamps
  /// as long as none is later than this behind its successors.
  double reorder_window_s = 5.0;
  /// Images are written here as they are met, so that memory stays bounded; needed where the map has a
  /// CAMERA. Raw ones as PNG, compressed ones as they are.
  std::filesystem::path image_folder;
  /// A message that cannot be used is an error, else it is left out and counted.
  bool strict = false;
};

using SampleSink = std::function<void(Sample&&)>;

/// Hands every sample to the sink, in time order; what is returned has everything but the samples. Memory
/// does not depend on the bag's length, but for the reference.
///
/// Stamps are the header's. Several DVL_BEAMS topics with equal stamps become the beams of one entry; a range
/// outside the message's limits, or infinite, is no echo. A negative first covariance entry of a field of
/// sensor_msgs/Imu says that the field is absent (REP 145). A twist that is not finite, or is PD0's -32768,
/// or whose first variance is negative or huge, is a DVL without bottom lock. The vehicle file's sigmas are
/// the medians of the messages' covariances.
///
/// Messages that cannot be used (a zero stamp, NaN, a quaternion that is not of unit norm, an image of
/// unknown encoding or of another size than its intrinsics) are left out, and said in the remarks.
///
/// Throws Error: not a bag, truncated or damaged; a topic of the map is not in the bag (the message lists
/// those that are), has the wrong type, or no message that can be used; a stamp older than the reorder
/// window, such as after a clock was set back.
ImportedRecording streamBag(const std::filesystem::path& bag, const TopicMap& map, const SampleSink& sink,
                            const BagOptions& options = {});

/// The same, with all samples in the result.
ImportedRecording importBag(const std::filesystem::path& bag, const TopicMap& map,
                            const BagOptions& options = {});

}  // namespace fathom
