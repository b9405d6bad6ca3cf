#pragma once

#include <deque>
#include <functional>
#include <limits>
#include <string>

#include "recording/samples.h"

namespace fathom {

/// Keeps one stamp from the future from dragging the filter there, where all that comes after it would be too
/// late. A reading far ahead of all before it waits aside. When others go on where they were, it is named,
/// and waits until their time has come so far; when kBelieved follow one another there, time itself has gone
/// on (all sensors paused), and they are taken. The first reading of all waits for a second one. At most
/// kMost wait.
class FutureStamps {
 public:
  static constexpr double kAhead_s = 5.0;  ///< or kIntervals mean intervals, where readings are rare
  static constexpr double kIntervals = 10.0;
  static constexpr std::size_t kBelieved = 10;
  static constexpr std::size_t kMost = 1000;

  using Take = std::function<void(const Sample& sample, double t_s)>;
  using Report = std::function<void(double t_s, const char* kind, std::string text)>;
  FutureStamps(Take take, Report report) : take_(std::move(take)), report_(std::move(report)) {}

  void add(const Sample& sample, double t_s);
  /// Takes what follows one another at the end, and names the rest.
  void finish();

 private:
  struct Waiting {
    Sample sample;
    double t_s;
    bool named = false;
  };
  double ahead_s() const;
  bool isAhead(double t_s) const { return t_s > newest_s_ + ahead_s(); }
  bool followOneAnother(std::size_t count) const;
  void take(const Sample& sample, double t_s);
  void takeReached();
  void nameWaiting();

  Take take_;
  Report report_;
  double first_s_ = 0.0, newest_s_ = -std::numeric_limits<double>::infinity(), taken_ = 0.0;
  std::deque<Waiting> waiting_;  ///< in order of arrival
  std::size_t in_a_row_ = 0;     ///< of them, since the last reading that did not wait
};

}  // namespace fathom
