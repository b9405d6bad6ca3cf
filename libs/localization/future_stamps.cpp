#include "localization/future_stamps.h"

#include <algorithm>

#include "core/text.h"

namespace fathom {

void FutureStamps::add(const Sample& sample, double t_s) {
  if (!isAhead(t_s)) {
    if (!waiting_.empty()) nameWaiting();
    in_a_row_ = 0;
    take(sample, t_s);
    if (!waiting_.empty()) takeReached();
    return;
  }
  if (waiting_.size() == kMost) {
    nameWaiting();
    waiting_.pop_front();
  }
  waiting_.push_back({sample, t_s});
  ++in_a_row_;
  constexpr std::size_t kAtFirst = 2;
  if (followOneAnother(taken_ == 0.0 ? kAtFirst : kBelieved)) {
    newest_s_ = std::max(newest_s_, waiting_.back().t_s);
    takeReached();
  }
}

void FutureStamps::finish() {
  const bool alone = taken_ == 0.0 && waiting_.size() == 1;  // a recording of one reading
  if (alone || followOneAnother(std::max<std::size_t>(2, in_a_row_))) {
    newest_s_ = std::max(newest_s_, waiting_.back().t_s);
    takeReached();
  }
  nameWaiting();
}

double FutureStamps::ahead_s() const {
  constexpr double kAtFirst_s = 60.0;  // before there is an interval
  if (taken_ < 2.0) return kAtFirst_s;
  return std::max(kAhead_s, kIntervals * (newest_s_ - first_s_) / (taken_ - 1.0));
}

/// Whether the last so many that wait came in a row, and none is far from the next.
bool FutureStamps::followOneAnother(std::size_t count) const {
  if (in_a_row_ < count || waiting_.size() < count) return false;
  const double limit_s = ahead_s();
  return std::adjacent_find(waiting_.end() - static_cast<std::ptrdiff_t>(count), waiting_.end(),
                            [&](const Waiting& a, const Waiting& b) {
                              return std::abs(b.t_s - a.t_s) > limit_s;
                            }) == waiting_.end();
}

void FutureStamps::take(const Sample& sample, double t_s) {
  if (taken_ == 0.0) first_s_ = t_s;
  taken_ += 1.0;
  newest_s_ = std::max(newest_s_, t_s);
  take_(sample, t_s);
}

/// Those whose time has come, in order of arrival.
void FutureStamps::takeReached() {
  std::deque<Waiting> waiting = std::move(waiting_);
  waiting_.clear();
  for (Waiting& w : waiting)
    if (isAhead(w.t_s))
      waiting_.push_back(std::move(w));
    else
      take(w.sample, w.t_s);
  in_a_row_ = 0;
}

void FutureStamps::nameWaiting() {
  for (Waiting& w : waiting_)
    if (!std::exchange(w.named, true))
      report_(w.t_s, "from-the-future",
              w.sample.label + (taken_ == 0.0 ? " is stamped far from all others"
                                              : print(" is stamped %.3f s after all others; it waits",
                                                      w.t_s - newest_s_)));
}

}  // namespace fathom
