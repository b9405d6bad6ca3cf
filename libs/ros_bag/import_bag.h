#pragma once

#include <filesystem>

#include "recording/imported.h"
#include "ros_bag/bag_options.h"
#include "ros_bag/topic_map.h"

/// ROS 1 bags.
namespace fathom {

/// Hands every sample to the sink, in time order; what is returned has everything but the samples. Memory
/// does not depend on the bag's length, but for the reference.
///
/// Stamps are the header's. Several DVL_BEAMS topics with equal stamps become the beams of one entry; a range
/// outside the message's limits, or infinite, is no echo. A negative first covariance entry of a field of
/// sensor_msgs/Imu says that the field is absent (REP 145); a huge one, a quaternion of zeros or of NaN say
/// so of the attitude. A twist that is not finite, or is what drivers write for no number (PD0's -32768,
/// -99999), or one of whose variances is negative or huge, or that is exactly zero with a variance far above
/// the usual one, is a DVL without bottom lock. The vehicle file's sigmas are the medians of the messages'
/// covariances.
///
/// Messages that cannot be used (too short for their type, a zero stamp or a single one of another time, NaN,
/// a quaternion far from unit norm, no pressure, an image of unknown encoding or of another size than
/// its intrinsics) are left out, and said in the remarks.
///
/// What transforms say twice and otherwise, and a reference whose stamps are late against their arrival, is
/// said in the remarks, too.
///
/// Throws Error: not a bag, truncated or damaged; a topic of the map is not in the bag (the message lists
/// those that are), has the wrong type, or no message that can be used; a topic whose stamps step back, or
/// are farther from the others' than the reorder window; a reference with no time in common with the sensors.
ImportedRecording streamBag(const std::filesystem::path& bag, const TopicMap& map, const SampleSink& sink,
                            const BagOptions& options = {});

/// The same, with all samples in the result.
ImportedRecording importBag(const std::filesystem::path& bag, const TopicMap& map,
                            const BagOptions& options = {});

}  // namespace fathom
