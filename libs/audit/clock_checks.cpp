#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "audit/checks.h"
#include "core/median.h"
#include "core/text.h"

namespace fathom {
namespace {
using enum Finding::Certainty;

constexpr std::size_t kFewestEntries = 50;  ///< entries

/// What of an instrument's section is compared with its stamps, by label. Beams have many entries a ping.
std::map<std::string, double> ratesOf(const Vehicle& vehicle) {
  std::map<std::string, double> rates;
  vehicle.forEachInstance([&](const Instance& instance, const SensorsOnBoard& on_board) {
    forEachInstrument([&]<class Instrument>() {
      if constexpr (!requires { Instrument::numbered; })
        if (const auto& sheet = on_board.*Instrument::on_board)
          rates[instance.label(Instrument::label)] = sheet->rate_hz;
    });
  });
  return rates;
}

class ClockCheck {
 public:
  ClockCheck(const std::string& label, const StampStream& stream, std::vector<Finding>& findings)
      : label_(label), stream_(stream), findings_(findings) {
    std::vector<double> t_s;
    for (const double now_s : stream.t_s) {
      // Back to no less than what the one before came after: it alone was ahead.
      const bool was_ahead =
          t_s.size() > 1 && t_s.back() - now_s > kFarAhead_s && now_s >= t_s[t_s.size() - 2];
      if (was_ahead) {
        ahead_s_.push_back(t_s.back() - now_s);
        t_s.pop_back();
      }
      t_s.push_back(now_s);
    }
    for (std::size_t i = 1; i < t_s.size(); ++i) intervals_.push_back(t_s[i] - t_s[i - 1]);
  }

  void check() {
    const double entries = static_cast<double>(stream_.t_s.size() + stream_.without_stamp);
    const auto share = [&](std::size_t count) { return static_cast<double>(count) / entries; };
    if (stream_.without_stamp > 0)
      add("stamps-missing", share(stream_.without_stamp) > 0.5 ? sure : likely,
          print("%zu of %.0f entries have no stamp", stream_.without_stamp, entries));
    if (stream_.t_s.size() < kFewestEntries) return;
    if (!ahead_s_.empty())
      add("stamps-ahead", likely,
          print("%zu of %.0f entries have a stamp ahead of the next entry's, by up to %.4g s",
                ahead_s_.size(), entries, *std::max_element(ahead_s_.begin(), ahead_s_.end())));
    const auto equal = static_cast<std::size_t>(std::count(intervals_.begin(), intervals_.end(), 0.0));
    const auto back = static_cast<std::size_t>(
        std::count_if(intervals_.begin(), intervals_.end(), [](double dt) { return dt < 0; }));
    if (share(equal) > 0.01)
      add("stamps-equal", share(equal) > 0.5 ? sure : likely,
          print("%zu of %.0f entries have the stamp of the one before", equal, entries));
    if (back > 0) {
      const double farthest = -*std::min_element(intervals_.begin(), intervals_.end());
      add("stamps-step-back", farthest > 1 ? sure : likely,
          print("its stamps step back %zu times, by up to %.4g s", back, farthest));
    }
    // A recording is in the order of its entries' stamps.
    const double behind = upperMedian(stream_.behind_s);
    if (back == 0 && behind > 0.2)
      add("clock-offset", behind > 1 ? sure : likely,
          print("its stamps are %.4g s behind those of the entries before it (median)", behind));
    if (share(equal) <= 0.01 && back == 0) checkRegularity();
  }

  /// Of all entries, losses included.
  double meanRate() const {
    return static_cast<double>(intervals_.size()) / (stream_.t_s.back() - stream_.t_s.front());
  }

  /// Mean of the intervals that are about the median one, and how sure of it; seconds.
  std::optional<std::pair<double, double>> meanInterval() const {
    if (stream_.t_s.size() < kFewestEntries) return {};
    const double median = upperMedian(intervals_);
    double sum = 0, squares = 0, count = 0;
    for (const double dt : intervals_)
      if (dt > 0.5 * median && dt < 1.5 * median) sum += dt, squares += dt * dt, ++count;
    if (median <= 0 || count < 0.9 * static_cast<double>(intervals_.size())) return {};
    const double mean = sum / count;
    // Jitter of single stamps cancels in the sum but for its ends.
    return std::pair(mean, std::sqrt(std::max(0.0, squares / count - mean * mean)) / count + 1e-7 / count);
  }

 private:
  void add(const std::string& name, Finding::Certainty certainty, std::string what) {
    findings_.push_back(finding(name + ":" + label_, label_, {}, certainty, std::move(what)));
  }

  /// Stamps of arrival come in bundles, or late by chance: many at once, then none for long. What is only
  /// left out leaves longer intervals, never shorter ones.
  void checkRegularity() {
    const double mean = (stream_.t_s.back() - stream_.t_s.front()) / static_cast<double>(intervals_.size());
    if (comesInBundles(mean))
      return add("stamps-of-arrival", likely,
                 print("half of its entries or more follow the one before within %.2g s, at a mean interval "
                       "of %.4g s: "
                       "they arrive in bundles",
                       kBundled_s, mean));
    double usual = 0, count = 0;  // without pauses
    for (const double dt : intervals_)
      if (dt < 10 * mean) usual += dt, ++count;
    usual /= count;
    std::vector<double> sorted = intervals_;
    std::sort(sorted.begin(), sorted.end());
    const double shortest = sorted[sorted.size() / 10];
    const auto whole = std::count_if(intervals_.begin(), intervals_.end(), [&](double dt) {
      return std::abs(dt / shortest - std::round(dt / shortest)) < 0.1;
    });
    if (static_cast<double>(whole) > 0.9 * static_cast<double>(intervals_.size())) return;
    const auto shorter =
        std::count_if(intervals_.begin(), intervals_.end(), [&](double dt) { return dt < 0.5 * usual; });
    const double share = static_cast<double>(shorter) / static_cast<double>(intervals_.size());
    if (share > 0.2)
      add("stamps-of-arrival", likely,
          print("%.0f %% of its intervals are shorter than half the usual one, %.4g s: stamps of arrival, "
                "not of "
                "measurement",
                100 * share, usual));
  }

  /// Faster than an instrument measures, with pauses that are shorter than one that rests.
  static constexpr double kBundled_s = 1e-3;
  bool comesInBundles(double mean_s) const {
    constexpr double kPause_s = 1.0;
    if (upperMedian(intervals_) > kBundled_s || mean_s < 3.0 * kBundled_s) return false;
    const auto rests =
        std::count_if(intervals_.begin(), intervals_.end(), [](double dt) { return dt > kPause_s; });
    return static_cast<double>(rests) < 0.01 * static_cast<double>(intervals_.size());
  }

  const std::string label_;
  const StampStream& stream_;
  std::vector<Finding>& findings_;
  /// Single stamps that are further ahead are mistakes, not a queue's disorder.
  static constexpr double kFarAhead_s = 1.0;
  std::vector<double> intervals_;  ///< without the stamps that alone are ahead
  std::vector<double> ahead_s_;    ///< how far those are
};

/// One sensor's clock runs otherwise than the others', by thousandths: its rate is off what the vehicle file
/// says, theirs is not. (By hundredths it would be the rate that is nominal.) What is lost lowers the rate of
/// all entries, not the interval between neighbours: where the vehicle file has the one or the other, all is
/// well.
void checkRates(const std::map<std::string, std::array<double, 2>>& ratios, std::vector<Finding>& findings) {
  constexpr double kQuartz = 3e-4, kMost = 0.007, kEqual = 1e-4;
  if (ratios.size() < 2) return;
  const auto offBy = [](const std::array<double, 2>& r) {
    return std::min(std::abs(r[0] - 1), std::abs(r[1] - 1));
  };
  for (const auto& one : ratios) {
    const double off = offBy(one.second);
    const bool alone = std::all_of(ratios.begin(), ratios.end(), [&](const auto& other) {
      return other.first == one.first || offBy(other.second) < kEqual;
    });
    if (off < kQuartz || off > kMost || !alone) continue;
    const double ratio = one.second[0];
    findings.push_back(finding(
        "clock-rate:" + one.first, one.first, {}, likely,
        print("its entries come at %.6g of the vehicle file's rate_hz, those of all others at 1: its clock "
              "runs %.0f ppm "
              "%s, or its rate is another; --correct clock-rate:%s:%.7g would stretch its stamps",
              ratio, 1e6 * std::abs(1 / ratio - 1), ratio < 1 ? "fast" : "slow", one.first.c_str(), ratio)));
  }
}

/// A stream that has no time in common with the others.
void checkOverlap(const Streams& streams, const std::map<std::string, double>& rates,
                  std::vector<Finding>& findings) {
  struct Span {
    double from_s, to_s;
  };
  std::map<std::string, Span> spans;
  for (const auto& [label, stream] : streams.stamps)
    if (rates.contains(label) && stream.t_s.size() > 1) {
      const auto [from, to] = std::minmax_element(stream.t_s.begin(), stream.t_s.end());
      spans[label] = {*from, *to};
    }
  for (const auto& one : spans) {
    const bool alone = spans.size() > 1 && std::all_of(spans.begin(), spans.end(), [&](const auto& other) {
                         return other.first == one.first || one.second.to_s < other.second.from_s ||
                                one.second.from_s > other.second.to_s;
                       });
    if (alone)
      findings.push_back(finding(
          "clock-offset:" + one.first, one.first, {}, sure,
          print("its stamps, from %.3f to %.3f s, have no time in common with those of any other sensor",
                one.second.from_s, one.second.to_s)));
  }
}

}  // namespace

void checkClocks(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings) {
  std::map<std::string, std::array<double, 2>> ratios;
  const std::map<std::string, double> rates = ratesOf(vehicle);
  checkOverlap(streams, rates, findings);
  for (const auto& [label, rate_hz] : rates) {
    const auto stream = streams.stamps.find(label);
    if (stream == streams.stamps.end()) continue;
    ClockCheck clock(label, stream->second, findings);
    clock.check();
    if (const auto mean = clock.meanInterval(); mean && mean->second < 2e-5 * mean->first)
      ratios[label] = {1 / (mean->first * rate_hz), clock.meanRate() / rate_hz};
  }
  checkRates(ratios, findings);
}

}  // namespace fathom
