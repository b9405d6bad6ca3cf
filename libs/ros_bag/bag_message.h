#pragma once

#include <rosbag/message_instance.h>

#include <cmath>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include "core/error.h"
#include "core/geometry.h"
#include "core/time.h"
#include "ros_bag/ros_messages.h"
#include "ros_bag/topic_map.h"

/// A message of a ROS 1 bag, and its fields as this program has them.
namespace fathom {

inline Vector3d toVector(const ros1::Vector3& v) { return {v.x, v.y, v.z}; }
inline Vector3d toVector(const ros1::Point& p) { return {p.x, p.y, p.z}; }

/// To the nearest 100 ns, the unit of Time.
inline Time toTime(const ros::Time& stamp) {
  return fromUnixSeconds(stamp.sec) + Time::duration((stamp.nsec + 50) / 100);
}

inline constexpr const char* kNoStamp =
    "has no time stamp; `stamps: arrival` in the topic map takes the bag's own";

/// A message that cannot be used. Others of its topic can.
class BadMessage : public Error {
 public:
  using Error::Error;
};

/// One message, where it stands for error messages, and the checks that every field goes through.
class BagMessage {
 public:
  /// Instance and bag are referred to and must outlive it. number: among its topic's messages, from 1 on.
  BagMessage(const rosbag::MessageInstance& instance, const std::string& bag, std::size_t number,
             TopicStamps stamps)
      : instance_(instance), bag_(bag), number_(number), stamps_(stamps) {}

  /// With the stamp that is asked for in its header. Throws Error where its definition is not M's, and where
  /// it has no time stamp.
  template <class M>
  boost::shared_ptr<M> as() const {
    auto message = asUnstamped<M>();
    message->header.stamp = stampOf(message->header);
    if (message->header.stamp.isZero()) throw error(kNoStamp);
    return message;
  }
  /// The one that is asked for: the header's, or the bag's.
  template <class Header>
  ros::Time stampOf(const Header& header) const {
    return stamps_ == TopicStamps::arrival ? instance_.getTime() : header.stamp;
  }
  /// Of those that have no header.
  template <class M>
  boost::shared_ptr<M> asUnstamped() const {
    auto message = decoded<M>();
    if (!message) throw error("its definition is not that of " + instance_.getDataType());
    return message;
  }
  /// When the bag received it.
  ros::Time arrival() const { return instance_.getTime(); }
  std::size_t number() const { return number_; }
  const std::string& topic() const { return instance_.getTopic(); }
  /// type: as ROS names it, "nav_msgs/Odometry".
  bool is(const std::string& type) const { return instance_.getDataType() == type; }

  /// The value itself; throws Error that names the field where it is not finite.
  Vector3d finite(const Vector3d& v, const std::string& field) const;
  double finite(double value, const std::string& field) const;
  /// Throws Error, with the norm, where it is off one by more than a fifth: that is no rounding of a
  /// rotation.
  Matrix3d rotation(const ros1::Quaternion& q) const;
  /// An Error about this message, to be thrown.
  BadMessage error(const std::string& why) const;
  /// The topic, and its number there.
  std::string where() const;
  const std::string& bag() const { return bag_; }

 private:
  /// Null where the definition is another. A message may be too short for its type in a bag that is whole.
  template <class M>
  boost::shared_ptr<M> decoded() const {
    try {
      return instance_.instantiate<M>();
    } catch (const ros::Exception&) {
    } catch (const std::bad_alloc&) {
    } catch (const std::length_error&) {
    }
    throw error("is too short for a " + instance_.getDataType() + ", or a length in it is damaged");
  }

  const rosbag::MessageInstance& instance_;
  const std::string& bag_;
  std::size_t number_;
  TopicStamps stamps_;
};

/// Sigma from the largest variance on a part of a covariance's diagonal; 0 where it is not given.
template <std::size_t N>
double sigmaFrom(const boost::array<double, N>& covariance, int first, int count) {
  constexpr int kSize = N == 36 ? 6 : 3;
  static_assert(N == 36 || N == 9);
  const Eigen::Map<const Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>> c(covariance.data());
  const double largest = c.diagonal().segment(first, count).maxCoeff();
  return largest > 0.0 && std::isfinite(largest) ? std::sqrt(largest) : 0.0;
}

}  // namespace fathom
