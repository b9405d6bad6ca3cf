#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "core/time.h"
#include "ros_bag/topic_map.h"
#include "ros_bag/typical_sigma.h"

/// The vehicle file of a ROS 1 bag: what its messages say of the sensors, the rest generic.
namespace fathom {

/// How often messages came.
struct MessagePace {
  std::size_t count = 0;
  Time first{}, last{};

  void add(Time time) {
    if (count++ == 0) first = last = time;
    first = std::min(first, time);
    last = std::max(last, time);
  }
  /// Mean; 1 of messages that span no time.
  double rate_hz() const {
    const double span = secondsBetween(first, last);
    return span > 0.0 ? static_cast<double>(count - 1) / span : 1.0;
  }
};

/// As the messages say, SI units.
struct MessageSigmas {
  TypicalSigma gyro, accelerometer, attitude, velocity_xy, velocity_z, pressure, position;
  int image_bits = 8;
};

/// Text of a vehicle file, a section for each topic of the map that had messages; comments say where each
/// number is from.
std::string vehicleYaml(const TopicMap& map, const std::map<TopicRole, MessagePace>& paces,
                        const MessageSigmas& sigmas);

}  // namespace fathom
