#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "core/time.h"
#include "ros_bag/bag_message.h"

namespace fathom {

/// What to do about stamps that are of no use.
inline constexpr const char* kTakeArrival =
    "; `stamps: arrival` in the topic map takes the bag's own, of arrival";

/// Whether each topic's stamps go on as they should: a message that arrives later was not measured before,
/// and all topics have one clock. Which of them does not is told by the bag's own times, of arrival.
class TopicClocks {
 public:
  /// Beyond window_s stamps are of another time.
  explicit TopicClocks(double window_s) : window_s_(window_s) {}

  /// Throws BadMessage where this message's stamp alone is of another time than its topic's before; Error
  /// where those after it are, too, or where the topic's stamps step back by more than a driver's jitter.
  /// stream: of several in one topic, whose stamps are each their own.
  void check(const BagMessage& message, Time stamp, const std::string& stream = "");
  /// An Error, to be thrown, about the topic whose stamps are farthest from all others' when this message
  /// does not fit them.
  Error apart(const BagMessage& message) const;
  /// How far the last stamps are ahead of others', by their times of arrival; s. Of the two that are nearest.
  double aheadOf(const TopicClocks& others) const;

 private:
  struct Moment {
    Time stamp, arrival;
    std::size_t number = 0;  ///< of the message
    double ahead_s() const { return secondsBetween(arrival, stamp); }
  };
  struct Clock {
    Moment last;
    std::optional<Moment> stray;  ///< the last one, where that was of another time
  };

  bool follows(const Moment& before, const Moment& now) const;

  double window_s_;
  std::map<std::string, Clock> clocks_;  ///< by topic, and stream
};

}  // namespace fathom
