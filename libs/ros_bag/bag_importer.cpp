#include "ros_bag/bag_importer.h"

#include <rosbag/view.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "core/error.h"
#include "core/text.h"

namespace fathom {
namespace {

using TopicTypes = std::map<std::string, std::string>;

/// By convention beside a topic of transforms, also within a namespace; /tf_static is the one of all others.
std::string staticTransformsBeside(const std::string& topic, const TopicTypes& types) {
  const std::string own = topic + "_static";
  return types.contains(own) ? own : "/tf_static";
}

}  // namespace

void BagImporter::checkTopics(const rosbag::Bag& bag) {
  rosbag::View view(bag);
  TopicTypes types;
  for (const auto* connection : view.getConnections()) types[connection->topic] = connection->datatype;
  std::ostringstream present;
  for (const auto& [topic, type] : types)
    present << (present.tellp() > 0 ? ", " : "") << topic << " (" << type << ')';
  if (types.empty()) present << "nothing";
  for (const BagTopic& topic : map_.topics) {
    const auto found = types.find(topic.topic);
    if (found == types.end())
      throw Error(bag_, topic.topic,
                  "no such topic (" + map_.file + " asks for it); the bag has " + present.str());
    if (topic.as == TopicRole::reference) {
      static_transforms_ = staticTransformsBeside(topic.topic, types);
      of_transforms_ = isTransforms(found->second) || found->second == "geometry_msgs/TransformStamped";
    }
    const auto& suitable = messageTypesOf(topic.as);
    if (std::find(suitable.begin(), suitable.end(), found->second) != suitable.end()) continue;
    std::string wanted;
    for (const std::string& type : suitable) wanted += (wanted.empty() ? "" : " or ") + type;
    throw Error(bag_, topic.topic,
                std::string("is a ") + found->second + "; " + roleName(topic.as) + " is made of " + wanted);
  }
}

void BagImporter::take(const BagTopic& topic, const BagMessage& message) {
  switch (topic.as) {
    case TopicRole::ins:
      return takeIns(topic, message);
    case TopicRole::dvl:
      return takeDvl(topic, message);
    case TopicRole::dvl_beams:
      return takeBeam(topic, message);
    case TopicRole::depth:
      return takeDepth(topic, message);
    case TopicRole::usbl:
      return takeUsbl(topic, message);
    case TopicRole::camera:
      return takeImage(topic, message);
    case TopicRole::reference:
      return takeReference(topic, message);
  }
}

void BagImporter::push(const BagTopic& topic, Time time, Reading reading, const BagMessage& message) {
  clocks_.check(message, time);
  if (!order_.fits(time)) throw clocks_.apart(message);
  paces_[topic.as].add(time);
  order_.push({time, roleName(topic.as), std::move(reading)});
}

/// One bad message does not refuse a bag.
void BagImporter::takeOrLeaveOut(const std::string& topic, const std::function<void()>& take) {
  constexpr std::size_t kQuoted = 3;
  try {
    take();
  } catch (const BadMessage& bad) {
    if (options_.strict) throw;
    if (std::exchange(last_bad_[topic], bad.where) == bad.where) return;
    ++bad_count_[topic];
    if (bad_[topic].size() < kQuoted) bad_[topic].push_back(bad);
  }
}

/// Those asked for of which no message at all can be used.
void BagImporter::refuseUnusableTopics() const {
  for (const BagTopic& asked : map_.topics)
    if (const auto bad = bad_count_.find(asked.topic);
        bad != bad_count_.end() && bad->second >= count_.at(asked.topic))
      throw Error(bad_.at(asked.topic).front());
}

/// Off norm by what drivers round or calibrate away it is a rotation yet.
Matrix3d BagImporter::rotationIn(const BagMessage& message, const ros1::Quaternion& q) {
  constexpr double kRounding = 0.01;
  Matrix3d rotation = message.rotation(q);
  const double norm = Eigen::Vector4d(q.x, q.y, q.z, q.w).norm();
  if (std::abs(norm - 1) > kRounding) {
    double& worst = worst_norm_.try_emplace(message.topic(), 1).first->second;
    if (std::abs(norm - 1) > std::abs(worst - 1)) worst = norm;
  }
  return rotation;
}

std::vector<std::string> BagImporter::remarks() const {
  std::vector<std::string> lines = reference_remarks_;
  for (const auto& [topic, norm] : worst_norm_)
    lines.push_back(topic + print(": its quaternions are off unit norm, up to %.3g, and normalized", norm));
  for (const auto& [topic, count] : without_lock_)
    lines.push_back(topic +
                    print(": %zu of %zu messages say that there is no bottom lock", count, count_.at(topic)));
  for (const auto& [topic, count] : without_attitude_)
    lines.push_back(topic +
                    print(": %zu of %zu messages have no attitude: their quaternion is zero or no number",
                          count, count_.at(topic)));
  for (const auto& [topic, count] : bad_count_) {
    std::string line = topic + print(": %zu of %zu messages are left out", count, count_.at(topic));
    const char* between = ": ";
    for (const BadMessage& bad : bad_.at(topic)) {
      line.append(between).append(bad.where).append(": ").append(bad.why);
      between = "; ";
    }
    lines.push_back(line);
  }
  return lines;
}

ImportedRecording BagImporter::run() {
  const bool has_camera = std::any_of(map_.topics.begin(), map_.topics.end(),
                                      [](const BagTopic& t) { return t.as == TopicRole::camera; });
  if (has_camera && options_.image_folder.empty())
    throw Error(map_.file, "CAMERA", "no folder is given for the images");

  rosbag::Bag bag;
  bag.open(bag_, rosbag::bagmode::Read);  // not in the constructor: that leaks when it throws
  checkTopics(bag);
  std::vector<std::string> topics;
  for (const BagTopic& topic : map_.topics) topics.push_back(topic.topic);
  if (of_transforms_) topics.emplace_back(static_transforms_);
  rosbag::View view(bag, rosbag::TopicQuery(topics));
  for (const rosbag::MessageInstance& instance : view) {
    const std::size_t number = ++count_[instance.getTopic()];
    for (const BagTopic& topic : map_.topics)
      if (topic.topic == instance.getTopic())
        takeOrLeaveOut(topic.topic, [&] { take(topic, {instance, bag_, number, topic.stamps}); });
    if (of_transforms_ && instance.getTopic() == static_transforms_ && isTransforms(instance.getDataType()))
      takeOrLeaveOut(static_transforms_, [&] {
        takeTransforms({instance, bag_, number, TopicStamps::header}, true);
      });
  }
  order_.flush();
  refuseUnusableTopics();
  if (!order_.first()) throw Error(bag_, "", "has no message of a sensor in " + map_.file);

  finishReference();
  ImportedRecording recording;
  recording.header.description = map_.description.empty()
                                     ? "ROS bag " + std::filesystem::path(bag_).filename().string()
                                     : map_.description;
  recording.start = *order_.first();
  recording.reference = std::move(reference_);
  recording.vehicle_yaml = vehicleYaml(map_, paces_, sigmas_);
  for (const BagTopic& topic : map_.topics)
    if (topic.as == TopicRole::ins) recording.conclusions = checks_.conclusions(topic);
  recording.remarks = remarks();
  return recording;
}

}  // namespace fathom
