#include "ros_bag/import_bag.h"

#include <console_bridge/console.h>

#include <new>
#include <stdexcept>

#include "core/error.h"
#include "core/files.h"
#include "ros_bag/bag_check.h"
#include "ros_bag/bag_importer.h"

namespace fathom {
namespace {

/// ROS prints what it throws; here the Error says it.
struct SilentRos {
  SilentRos() { console_bridge::noOutputHandler(); }
  ~SilentRos() { console_bridge::restorePreviousOutputHandler(); }
  SilentRos(const SilentRos&) = delete;
  SilentRos& operator=(const SilentRos&) = delete;
};

}  // namespace

ImportedRecording streamBag(const std::filesystem::path& bag, const TopicMap& map, const SampleSink& sink,
                            const BagOptions& options) {
  const auto unreadable = [&](const std::string& why) {
    return Error(bag.string(), "", "not a ROS 1 bag, or truncated or damaged: " + why);
  };
  if (!isFile(bag)) throw Error(bag.string(), "", "cannot be read");
  checkBag(bag);
  const SilentRos silent;
  try {
    return BagImporter(bag, map, sink, options).run();
  } catch (const ros::Exception& problem) {
    throw unreadable(problem.what());
  } catch (const std::bad_alloc&) {
    throw unreadable("a length in it is absurd");
  } catch (const std::length_error&) {
    throw unreadable("a length in it is absurd");
  }
}

ImportedRecording importBag(const std::filesystem::path& bag, const TopicMap& map,
                            const BagOptions& options) {
  std::vector<Sample> samples;
  ImportedRecording recording = streamBag(
      bag, map, [&](Sample&& sample) { samples.push_back(std::move(sample)); }, options);
  recording.samples = std::move(samples);
  return recording;
}

}  // namespace fathom
