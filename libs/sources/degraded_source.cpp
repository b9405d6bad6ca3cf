#include "sources/degraded_source.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/fingerprint.h"

namespace fathom {
namespace {

/// Stamps farther from the first than this are broken; they pass every stage as they are.
constexpr double kLongestRecording_s = 10 * 365.25 * 86400;

/// A stamp that is set, and leaves room for sums.
bool isTime(Time stamp) {
  constexpr Time::duration::rep kLatest = Time::duration::rep{1} << 62;
  return stamp.time_since_epoch().count() > 0 && stamp.time_since_epoch().count() < kLatest;
}

/// secondsBetween, without overflow where a stamp is garbage.
double secondsApart(Time a, Time b) {
  const auto ticks = [](Time t) { return static_cast<long double>(t.time_since_epoch().count()); };
  return static_cast<double>((ticks(b) - ticks(a)) * 1e-7L);
}

bool isLandmark(std::string_view label) {
  return baseOf(label) == labels::kMarkers || baseOf(label) == labels::kPanel;
}

}  // namespace

/// A stage and its random numbers, a stream for each sensor.
class DegradedSource::RunningStage {
 public:
  RunningStage(DegradationStage stage, std::uint64_t number) : stage_(std::move(stage)), number_(number) {}

  /// `since_first_s` is the sample's stamp. Appends what becomes of it.
  void apply(Arrival arrival, double since_first_s, std::vector<Arrival>& out) {
    const bool acts = stage_.concerns(arrival.sample.label) && since_first_s >= stage_.begin_s &&
                      since_first_s < stage_.end_s;
    if (!acts) {
      out.push_back(std::move(arrival));
      return;
    }
    const FaultContext context{since_first_s - stage_.begin_s, randomFor(arrival.sample)};
    std::visit([&](const auto& fault) { fault.apply(std::move(arrival), context, out); }, stage_.fault);
  }

 private:
  /// The sensor's stream; for landmarks one of this image's own, which begins anew for its other form.
  Random& randomFor(const Sample& sample) {
    if (!isLandmark(sample.label)) return streamOf(sample.label);
    if (image_ != sample.time) image_seed_ = streamOf(kLandmarks).bits();
    image_ = sample.time;
    return image_random_ = Random(image_seed_);
  }

  Random& streamOf(const std::string& sensor) {
    if (const auto it = streams_.find(sensor); it != streams_.end()) return it->second;
    const std::uint64_t seed = stage_.seed + number_ * 0x9e3779b97f4a7c15U;  // stages of one seed differ
    return streams_.emplace(sensor, Random::stream(seed, Fingerprint().add(sensor).value())).first->second;
  }

  DegradationStage stage_;
  std::uint64_t number_;
  std::map<std::string, Random> streams_;
  std::optional<Time> image_;  // the latest one's stamp
  std::uint64_t image_seed_ = 0;
  Random image_random_{0};
};

DegradedSource::DegradedSource(std::unique_ptr<SampleSource> source, std::vector<DegradationStage> stages)
    : source_(std::move(source)) {
  for (DegradationStage& stage : stages)
    stages_.push_back(std::make_unique<RunningStage>(std::move(stage), stages_.size()));
}

DegradedSource::~DegradedSource() = default;

bool DegradedSource::Later::operator()(const Held& a, const Held& b) const {
  if (a.arrival.arrival_s != b.arrival.arrival_s) return a.arrival.arrival_s > b.arrival.arrival_s;
  return a.number > b.number;
}

std::optional<Sample> DegradedSource::next() {
  const auto isDue = [this] {
    return !held_.empty() &&
           (ended_ || held_.front().arrival.arrival_s <= clock_s_ || held_.size() > kMostHeld);
  };
  while (!isDue() && !ended_) {
    if (auto sample = source_->next())
      admit(std::move(*sample));
    else
      ended_ = true;
  }
  if (held_.empty()) return std::nullopt;
  std::pop_heap(held_.begin(), held_.end(), Later{});
  Sample sample = std::move(held_.back().arrival.sample);
  held_.pop_back();
  return sample;
}

/// Sends a sample through the stages.
void DegradedSource::admit(Sample sample) {
  const bool timed = isTime(sample.time);
  if (timed) advanceClock(sample.time);
  std::vector<Arrival> arrivals, next;
  arrivals.push_back({clock_s_, std::move(sample)});
  for (const auto& stage : stages_) {
    next.clear();
    for (Arrival& arrival : arrivals) {
      const double since_first_s = timed ? secondsApart(*first_, arrival.sample.time) : 0.0;
      if (timed && std::abs(since_first_s) <= kLongestRecording_s)
        stage->apply(std::move(arrival), since_first_s, next);
      else
        next.push_back(std::move(arrival));
    }
    arrivals.swap(next);
  }
  for (Arrival& arrival : arrivals) {
    held_.push_back({std::move(arrival), admitted_++});
    std::push_heap(held_.begin(), held_.end(), Later{});
  }
}

void DegradedSource::advanceClock(Time stamp) {
  if (!first_) first_ = newest_ = stamp;
  const double step_s = secondsApart(newest_, stamp);
  if (step_s > 0 && step_s <= kLongestPause_s) clock_s_ += step_s;
  if (step_s > 0 || step_s < -kLongestPause_s) newest_ = stamp;
}

}  // namespace fathom
