#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "audit/acceleration_evidence.h"
#include "audit/checks.h"
#include "audit/correction.h"
#include "audit/sensor_units.h"
#include "audit/vertical_evidence.h"
#include "core/median.h"
#include "core/text.h"

namespace fathom {
namespace {
using enum Finding::Certainty;

class DvlCheck {
 public:
  DvlCheck(const Instance& instance, const Streams& streams, const DvlStream& stream, const Vehicle& vehicle,
           std::vector<Finding>& findings)
      : instance_(instance), streams_(streams), stream_(stream), vehicle_(vehicle), findings_(findings) {}

  void check() {
    if (stream_.velocities.size() < 20) return;
    checkRepeated();
    const bool witness =
        !streams_.ins.empty() && !hasFinding(findings_, Ins::label, streams_.ins.begin()->first);
    AccelerationEvidence evidence;
    if (witness) evidence = accelerationEvidence(stream_, streams_.ins.begin()->second);
    if (!checkUnit(evidence)) checkAxes(evidence);
    if (!hasFinding(findings_, Dvl::label, instance_)) checkSpeed();
    if (!hasFinding(findings_, Dvl::label, instance_)) checkUpAndDown();
  }

 private:
  Finding& add(const std::string& name, Finding::Certainty certainty, std::string what) {
    return findings_.emplace_back(finding(name, Dvl::label, instance_, certainty, std::move(what)));
  }

  void checkRepeated() {
    const double share =
        static_cast<double>(stream_.repeated) / static_cast<double>(stream_.velocities.size());
    if (share > 0.5)
      add("dvl-repeated", likely, print("%.0f %% of its velocities are exactly the one before", 100 * share));
  }

  /// By what the INS's acceleration makes, by the pressure, or else by the limit.
  bool checkUnit(const AccelerationEvidence& evidence) {
    const Regression all = evidence.all(), rise = riseOf({});
    std::vector<double> speeds;
    for (const auto& reading : stream_.velocities) speeds.push_back(reading.value.norm());
    std::sort(speeds.begin(), speeds.end());
    const double fast = speeds[speeds.size() * 95 / 100], limit = vehicle_.limits.speed_m_s;
    double times = 0;  // too large
    std::string what;
    if (all.count() >= 30 && std::abs(all.correlation()) > 0.7) {
      times = std::abs(all.slope());
      what = print("its velocity changes by %.4g times what the INS's acceleration makes", times);
    } else if (rise.count() >= 10 && std::abs(rise.correlation()) > 0.8) {
      times = std::abs(1 / rise.slope());
      what = print("it rises by %.4g times what the pressure falls", times);
    }
    const SensorUnit* unit = nullptr;
    for (const SensorUnit& u : kVelocityUnits)
      if (times * u.si > 0.6 && times * u.si < 1.6) unit = &u;
    const bool by_limit = times == 0 && fast > 2 * limit;
    if (by_limit) {
      // A speed that is usual.
      const auto unusual = [&](const SensorUnit& u) { return std::abs(std::log(fast * u.si / 0.5)); };
      unit =
          unusual(kVelocityUnits[0]) < unusual(kVelocityUnits[1]) ? &kVelocityUnits[0] : &kVelocityUnits[1];
      what = print("19 of 20 velocities are up to %.4g m/s, limits: speed_m_s of the vehicle file is %.4g",
                   fast, limit);
    }
    if (unit == nullptr) return false;
    Finding& found =
        add(unit->name, by_limit ? likely : sure, what + (by_limit ? "; perhaps " : "; ") + unit->says);
    found = correctable(found, print("up to %.4g m/s", fast * unit->si));
    return true;
  }

  /// The way up by the pressure over that by the velocity.
  Regression riseOf(const SignedAxes& axes) const {
    if (streams_.depth.empty() || hasFinding(findings_, Depth::label, streams_.depth.begin()->first))
      return {};
    return verticalEvidence(streams_, streams_.depth.begin()->second, vehicle_, findings_, axes);
  }

  /// Axes that agree much better with the INS's acceleration than its mounting's, and with the pressure where
  /// that changes. Several may: what does not move tells nothing.
  void checkAxes(const AccelerationEvidence& evidence) {
    if (evidence.changes.size() < 30) return;
    const double as_it_is = evidence.left();
    if (as_it_is < 0.2) return;
    struct Guess {
      SignedAxes axes;
      double left,
          rise;  ///< of the changes of velocity; correlation with the pressure, 1 where it tells nothing
    };
    std::vector<Guess> guesses;
    const Regression rise_as_it_is = riseOf({});
    const bool rises = rise_as_it_is.count() >= 10 && rise_as_it_is.rmsY() > 0.05;
    for (const SignedAxes& axes : allAxes())
      guesses.push_back({axes, leftWith(axes), rises ? riseOf(axes).correlation() : 1});
    std::erase_if(guesses, [](const Guess& g) { return g.rise < 0.8; });
    std::stable_sort(guesses.begin(), guesses.end(),
                     [](const Guess& a, const Guess& b) { return a.left < b.left; });
    if (guesses.size() < 2 || guesses[0].left > 0.1 || as_it_is < 4 * guesses[0].left ||
        guesses[0].axes == SignedAxes{})
      return;
    const Guess& best = guesses[0];
    const std::string what = print(
        "%.0f %% of the changes of velocity by the INS's acceleration are left; %.0f %% with its axes as %s",
        100 * std::sqrt(as_it_is), 100 * std::sqrt(best.left), best.axes.text().c_str());
    if (guesses[1].left < 2 * best.left + 0.005) {
      std::string others;
      for (std::size_t k = 1; k < 5 && k < guesses.size() && guesses[k].left < 2 * best.left + 0.005; ++k)
        others += ", or " + guesses[k].axes.text();
      add("dvl-axes", as_it_is > 10 * best.left ? sure : likely,
          what + others + ": which is not told (--correct dvl-axes:AXES), and it may be the INS's");
      return;
    }
    Finding& found = add("dvl-axes", as_it_is > 10 * best.left ? sure : likely, what);
    found = correctable(found, "its axes as " + best.axes.text(), plainText(best.axes));
  }

  void checkSpeed() {
    const double limit = vehicle_.limits.speed_m_s;
    double fastest = 0;
    std::size_t beyond = 0;
    for (const auto& reading : stream_.velocities) {
      fastest = std::max(fastest, reading.value.norm());
      if (reading.value.norm() > limit) ++beyond;
    }
    if (beyond * 100 > stream_.velocities.size())
      add("speed", beyond * 2 > stream_.velocities.size() ? sure : likely,
          print("velocities up to %.4g m/s; limits: speed_m_s of the vehicle file is %.4g", fastest, limit));
  }

  /// Axes by which the velocity rises as the pressure falls; of several those that suit the INS's
  /// acceleration best.
  void checkUpAndDown() {
    const Regression up = riseOf({});
    if (up.count() < 10 || up.rmsX() < 0.05) return;
    if (std::abs(up.correlation()) > 0.8 && isNear(up.slope(), 1, 0.5)) return;
    struct Guess {
      SignedAxes axes;
      double left, slope;
    };
    std::vector<Guess> guesses;
    for (const SignedAxes& axes : allAxes()) {
      const Regression down = riseOf(axes);
      if (axes.source[2] == 2 && axes.sign[2] < 0 && down.correlation() > 0.9 && isNear(down.slope(), 1, 0.4))
        guesses.push_back({axes, leftWith(axes), down.slope()});
    }
    std::stable_sort(guesses.begin(), guesses.end(),
                     [](const Guess& a, const Guess& b) { return a.left < b.left; });
    if (!guesses.empty() && up.correlation() < 0.5) {
      const Guess& best = guesses[0];
      Finding& found =
          add("dvl-axes", sure,
              print("the pressure falls by %.2f of how the DVL rises, by %.2f with its axes as %s",
                    up.slope(), best.slope, best.axes.text().c_str()));
      std::string others;
      for (std::size_t k = 1; k < 5 && k < guesses.size() && guesses[k].left < 1.5 * best.left + 0.02; ++k)
        others += ", or " + guesses[k].axes.text();
      if (others.empty())
        found = correctable(found, "its axes as " + best.axes.text(), plainText(best.axes));
      else
        found.what += others + ": which is not told (--correct dvl-axes:AXES)";
    } else if (std::abs(up.correlation()) > 0.8) {
      add("dvl-up-and-down", likely, print("the pressure falls by %.2f of how the DVL rises", up.slope()));
    }
  }

  double leftWith(const SignedAxes& axes) const {
    return accelerationEvidence(stream_, streams_.ins.begin()->second, {{}, {}, axes, 1}).left();
  }

  const Instance instance_;
  const Streams& streams_;
  const DvlStream& stream_;
  const Vehicle& vehicle_;
  std::vector<Finding>& findings_;
};

}  // namespace

void checkDvl(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings) {
  for (const auto& [instance, stream] : streams.dvl)
    DvlCheck(instance, streams, stream, vehicle, findings).check();
}

}  // namespace fathom
