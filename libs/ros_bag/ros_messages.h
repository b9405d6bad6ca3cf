#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/FluidPressure.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Range.h>
#include <tf2_msgs/TFMessage.h>

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

/// The ROS 1 messages that bags are read into (and, in tests, written from).
namespace fathom::ros1 {

/// std::allocator with `rebind`, which it lost in C++20 and which the messages and their serializers ask for.
/// Texts stay std::string. The serializers make room for as many bytes as a message claims before they look
/// whether it has them: no more than an image can need.
template <class T>
struct Allocator : std::allocator<T> {
  static constexpr std::size_t kMostBytes = std::size_t{256} << 20;

  template <class U>
  struct rebind {
    using other = std::conditional_t<std::is_same_v<U, char>, std::allocator<char>, Allocator<U>>;
  };
  Allocator() = default;
  template <class U>
  Allocator(const Allocator<U>&) {}
  T* allocate(std::size_t count) {
    if (count > kMostBytes / sizeof(T)) throw std::bad_alloc();
    return std::allocator<T>::allocate(count);
  }
};

using CompressedImage = sensor_msgs::CompressedImage_<Allocator<void>>;
using FluidPressure = sensor_msgs::FluidPressure_<Allocator<void>>;
using Image = sensor_msgs::Image_<Allocator<void>>;
using Imu = sensor_msgs::Imu_<Allocator<void>>;
using Odometry = nav_msgs::Odometry_<Allocator<void>>;
using Point = geometry_msgs::Point_<Allocator<void>>;
using Pose = geometry_msgs::Pose_<Allocator<void>>;
using PoseStamped = geometry_msgs::PoseStamped_<Allocator<void>>;
using PoseWithCovarianceStamped = geometry_msgs::PoseWithCovarianceStamped_<Allocator<void>>;
using Quaternion = geometry_msgs::Quaternion_<Allocator<void>>;
using Range = sensor_msgs::Range_<Allocator<void>>;
using TFMessage = tf2_msgs::TFMessage_<Allocator<void>>;
using TransformStamped = geometry_msgs::TransformStamped_<Allocator<void>>;
using TwistStamped = geometry_msgs::TwistStamped_<Allocator<void>>;
using TwistWithCovariance = geometry_msgs::TwistWithCovariance_<Allocator<void>>;
using TwistWithCovarianceStamped = geometry_msgs::TwistWithCovarianceStamped_<Allocator<void>>;
using Vector3 = geometry_msgs::Vector3_<Allocator<void>>;

}  // namespace fathom::ros1
