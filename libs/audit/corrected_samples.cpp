#include "audit/corrected_samples.h"

#include <algorithm>
#include <utility>

namespace fathom {

CorrectedSamples::CorrectedSamples(std::vector<Correction> corrections, Vehicle vehicle,
                                   std::function<void(Sample)> sink)
    : corrections_(std::move(corrections)), vehicle_(std::move(vehicle)), sink_(std::move(sink)) {
  for (const Correction& correction : corrections_) {
    slowest_ = std::min(slowest_, correction.slowest());
    earlier_s_ = std::max(earlier_s_, correction.earlier_s());
  }
}

void CorrectedSamples::push(Sample sample) {
  if (!time_zero_ && sample.time != Time{}) time_zero_ = sample.time;
  if (!time_zero_) return sink_(std::move(sample));
  // A stamp yet to come is no earlier than this one, and its correction no more than the slowest clock's.
  const Time safe = after(*time_zero_, slowest_ * secondsBetween(*time_zero_, sample.time) - earlier_s_);
  for (const Correction& correction : corrections_) correction.apply(sample, vehicle_, *time_zero_);
  const Time corrected = sample.time;
  held_.emplace(corrected, std::move(sample));
  while (!held_.empty() && held_.begin()->first <= safe) release();
}

void CorrectedSamples::flush() {
  while (!held_.empty()) release();
}

void CorrectedSamples::release() { sink_(std::move(held_.extract(held_.begin()).mapped())); }

std::optional<Sample> CorrectedSource::next() {
  while (ready_.empty()) {
    auto sample = source_->next();
    if (!sample) {
      corrected_.flush();
      break;
    }
    corrected_.push(std::move(*sample));
  }
  if (ready_.empty()) return std::nullopt;
  Sample sample = std::move(ready_.front());
  ready_.pop_front();
  return sample;
}

}  // namespace fathom
