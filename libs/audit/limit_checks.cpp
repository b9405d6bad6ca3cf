#include <algorithm>
#include <cmath>

#include "audit/checks.h"
#include "audit/sensor_units.h"
#include "core/text.h"

namespace fathom {
namespace {
using enum Finding::Certainty;

void checkTurnRates(const Instance& instance, const InsStream& stream, double limit,
                    std::vector<Finding>& findings) {
  std::size_t rates = 0, beyond = 0;
  double fastest = 0;
  for (const InsWindow& w : stream.windows) {
    if (w.rates == 0) continue;
    ++rates;
    fastest = std::max(fastest, w.rate.norm());
    if (w.rate.norm() > limit) ++beyond;
  }
  if (beyond * 100 <= rates) return;
  findings.push_back(finding(
      "turn-rate", Ins::label, instance, beyond * 2 > rates ? sure : likely,
      print("it turns by up to %.4g deg/s; more than limits: turn_rate_deg_s of the vehicle file, %.4g, "
            "in %.0f %%",
            degrees(fastest), degrees(limit),
            100.0 * static_cast<double>(beyond) / static_cast<double>(rates))));
}

/// Where most velocities are far beyond what the vehicle can, the unit is another, of which the usual speed
/// tells which; no other stream does.
void checkSpeeds(const Instance& instance, const DvlStream& stream, double limit,
                 std::vector<Finding>& findings) {
  if (stream.velocities.size() < 20) return;
  std::vector<double> speeds;
  for (const auto& reading : stream.velocities) speeds.push_back(reading.value.norm());
  std::sort(speeds.begin(), speeds.end());
  if (const double fast = speeds[speeds.size() * 95 / 100]; fast > 2 * limit) {
    constexpr double kUsual_m_s = 0.5;
    const auto unusual = [&](const SensorUnit& u) { return std::abs(std::log(fast * u.si / kUsual_m_s)); };
    const SensorUnit& unit =
        *std::min_element(kVelocityUnits.begin(), kVelocityUnits.end(),
                          [&](const SensorUnit& a, const SensorUnit& b) { return unusual(a) < unusual(b); });
    const Finding found = finding(
        unit.name, Dvl::label, instance, likely,
        print("19 of 20 velocities are up to %.4g m/s, limits: speed_m_s of the vehicle file is %.4g; "
              "perhaps %s",
              fast, limit, unit.says));
    findings.push_back(correctable(found, print("up to %.4g m/s", fast * unit.si)));
    return;
  }
  const auto beyond = static_cast<std::size_t>(
      std::count_if(speeds.begin(), speeds.end(), [&](double speed) { return speed > limit; }));
  if (beyond * 100 > speeds.size())
    findings.push_back(
        finding("speed", Dvl::label, instance, beyond * 2 > speeds.size() ? sure : likely,
                print("velocities up to %.4g m/s; limits: speed_m_s of the vehicle file is %.4g",
                      speeds.back(), limit)));
}

}  // namespace

void checkLimits(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings) {
  for (const auto& [instance, stream] : streams.ins)
    if (!hasFinding(findings, Ins::label, instance))
      checkTurnRates(instance, stream, vehicle.limits.turn_rate_rad_s, findings);
  for (const auto& [instance, stream] : streams.dvl)
    if (!hasFinding(findings, Dvl::label, instance))
      checkSpeeds(instance, stream, vehicle.limits.speed_m_s, findings);
}

}  // namespace fathom
