#include "localization/input_watch.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "recording/instrument_entries.h"

namespace fathom {
namespace {

bool allFinite(double value) { return std::isfinite(value); }
template <class Derived>
bool allFinite(const Eigen::MatrixBase<Derived>& value) {
  return value.allFinite();
}

struct IsFinite {
  template <class Entry>
  bool operator()(const Entry& entry) const {
    bool finite = true;
    if constexpr (kIsInstruments<Entry>)
      InstrumentOf<Entry>::forEachValue(
          entry, [&](int, const auto* value) { finite = finite && (value == nullptr || allFinite(*value)); });
    return finite;
  }
  bool operator()(const PoseSample& s) const {
    return s.T_odom_robot.mean.position.allFinite() && s.T_odom_robot.covariance.allFinite();
  }
  bool operator()(const PanelSample& s) const {
    return std::all_of(s.panels.begin(), s.panels.end(), [](const SeenPanel& seen) {
      const auto& [pose, covariance] = seen.T_camera_panel;
      return pose.position.allFinite() && pose.rotation.allFinite() && covariance.allFinite();
    });
  }
};

bool isWithin(double value, const ValueText& text) { return value >= text.lowest && value <= text.highest; }
bool isWithin(const Vector3d& value, const ValueText& text) {
  return value.minCoeff() >= text.lowest && value.maxCoeff() <= text.highest;
}
bool isWithin(const Matrix3d&, const ValueText&) { return true; }

/// Such a value is garbage, and no gate need weigh it: see ValueText::lowest.
bool isPossible(const Sample& sample) {
  bool possible = true;
  withInstrument(sample, [&]<class Instrument>(const auto& entry, const Instance&) {
    Instrument::forEachValue(entry, [&](int k, const auto* value) {
      const ValueText& text = Instrument::values[static_cast<std::size_t>(k)];
      possible = possible && (value == nullptr || text.lowest == text.highest || isWithin(*value, text));
    });
  });
  return possible;
}

}  // namespace

bool InputWatch::accept(const Sample& sample, double t_s) {
  if (!std::visit(IsFinite{}, sample.reading)) {
    report_(t_s, "not-a-number", sample.label + " has a value that is not finite; the entry is left out");
    return false;
  }
  if (!isPossible(sample)) {
    report_(t_s, "impossible", sample.label + " has a value beyond all bounds; the entry is left out");
    return false;
  }
  const auto [it, first] = sensors_.try_emplace(sample.label, Sensor{t_s});
  Sensor& sensor = it->second;
  const double interval_s = t_s - sensor.last_s;
  if (!first && interval_s == 0.0) {
    report_(t_s, "duplicate", sample.label + " repeats its time stamp; the second entry is left out");
    return false;
  }
  if (interval_s > options_.gap_s && isLongFor(sensor, interval_s))
    report_(t_s, "silent", sample.label + print(" was silent for %.3f s", interval_s));
  if (interval_s > 0.0) {
    sensor.last_s = t_s;
    sensor.sum_s += interval_s;
    sensor.count += 1.0;
  }
  if (any_ && t_s - newest_s_ > options_.gap_s)
    report_(t_s, "gap", print("no sensor for %.3f s; bridged by the motion model", t_s - newest_s_));
  if (any_ && newest_s_ - t_s > options_.history_s)
    report_(t_s, "time-jump", print("time jumps back by %.3f s", newest_s_ - t_s));
  newest_s_ = any_ ? std::max(newest_s_, t_s) : t_s;
  any_ = true;
  return true;
}

/// A sensor that is slow anyway is not silent: judged against its own mean interval so far.
bool InputWatch::isLongFor(const Sensor& sensor, double interval_s) const {
  return sensor.count == 0.0 || interval_s > 5.0 * sensor.sum_s / sensor.count;
}

}  // namespace fathom
