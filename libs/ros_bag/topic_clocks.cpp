#include "ros_bag/topic_clocks.h"

#include <cmath>
#include <tuple>

#include "core/text.h"

namespace fathom {
namespace {

constexpr double kJitter_s = 0.05;

}  // namespace

/// Whether it is of the same clock: soon after by its stamps, or as long after as it arrived.
bool TopicClocks::follows(const Moment& before, const Moment& now) const {
  const double after_s = secondsBetween(before.stamp, now.stamp);
  return std::abs(after_s) <= window_s_ || std::abs(now.ahead_s() - before.ahead_s()) <= window_s_;
}

void TopicClocks::check(const BagMessage& message, Time stamp, const std::string& stream) {
  const std::string of = stream.empty() ? "" : ", " + stream;
  const Moment now{stamp, toTime(message.arrival()), message.number()};
  const auto [entry, is_first] = clocks_.try_emplace(message.topic() + of, Clock{now, {}});
  if (is_first) return;
  Clock& clock = entry->second;
  const double after_s = secondsBetween(clock.last.stamp, stamp);
  const std::string jump = print("%.3f s %s", std::abs(after_s), after_s < 0 ? "before" : "after");
  if (!follows(clock.last, now)) {
    // A message that becomes two things is looked at twice.
    const bool is_another_clock =
        clock.stray && clock.stray->number != now.number && follows(*clock.stray, now);
    clock.stray = now;
    if (is_another_clock)
      throw Error(message.bag(), message.where() + of,
                  "the clock of its stamps was set: it and the one before are " + jump +
                      " those that came before them" + kTakeArrival);
    throw message.error("its stamp is " + jump + " the one before");
  }
  clock.stray.reset();
  if (after_s < -kJitter_s)
    throw Error(message.bag(), message.where() + of,
                print("its stamp steps back by %.3f s", -after_s) + kTakeArrival);
  clock.last = now;
}

double TopicClocks::aheadOf(const TopicClocks& others) const {
  std::optional<double> nearest_s;
  for (const auto& [topic, clock] : clocks_)
    for (const auto& [other_topic, other] : others.clocks_) {
      const double ahead_s = clock.last.ahead_s() - other.last.ahead_s();
      if (!nearest_s || std::abs(ahead_s) < std::abs(*nearest_s)) nearest_s = ahead_s;
    }
  return nearest_s.value_or(0);
}

Error TopicClocks::apart(const BagMessage& message) const {
  // Farthest from all others; of two, which are as far from each other, from the bag's own time.
  std::tuple<double, double> farthest{-1, 0};
  std::string odd;
  double ahead_s = 0;
  for (const auto& [topic, clock] : clocks_) {
    double sum_s = 0, nearest_s = 0;
    for (const auto& [other_topic, other] : clocks_) {
      const double apart_s = clock.last.ahead_s() - other.last.ahead_s();
      sum_s += std::abs(apart_s);
      if (&other != &clock && (nearest_s == 0 || std::abs(apart_s) < std::abs(nearest_s)))
        nearest_s = apart_s;
    }
    const std::tuple distance(std::round(sum_s), std::abs(clock.last.ahead_s()));
    if (distance <= farthest) continue;
    farthest = distance;
    odd = topic;
    ahead_s = nearest_s;
  }
  if (std::abs(ahead_s) <= window_s_)
    return {message.bag(), message.where(),
            print("its stamp is older than its predecessors' by more than the reorder window of %g s",
                  window_s_) +
                kTakeArrival};
  return {message.bag(), odd,
          print("its stamps are %.3f s %s the other topics', more than the reorder window of %g s",
                std::abs(ahead_s), ahead_s > 0 ? "ahead of" : "behind", window_s_) +
              kTakeArrival};
}

}  // namespace fathom
