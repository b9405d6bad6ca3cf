#include <algorithm>
#include <cmath>

#include "audit/checks.h"
#include "audit/vertical_evidence.h"
#include "audit/water_column.h"
#include "core/median.h"
#include "core/text.h"

namespace fathom {
namespace {
using enum Finding::Certainty;

class DepthCheck {
 public:
  DepthCheck(const Instance& instance, const DepthStream& stream, const Vehicle& vehicle,
             const Regression& vertical, std::vector<Finding>& findings)
      : instance_(instance),
        stream_(stream),
        vehicle_(vehicle),
        sheet_(sheetOf<Depth>(vehicle, instance)),
        vertical_(vertical),
        findings_(findings) {}

  void check() {
    if (stream_.pressures.size() < 10) return;
    std::vector<double> all;
    for (const auto& reading : stream_.pressures) all.push_back(reading.value);
    const double median = upperMedian(all), air = sheet_.atmospheric_pressure_pa;
    // Above sea level the air is thinner, of which the vehicle file need not know.
    const bool may_be_air =
        median > 0.5 * air && (!vertical_ok_ || isNear(std::abs(vertical_.slope()), 1, 0.3));
    if (median < 0.8 * air && may_be_air) {
      findings_.push_back(finding("pressure-below-air", Depth::label, instance_, likely,
                                  print("the pressure is %.6g Pa, less than the air's %.6g: "
                                        "atmospheric_pressure_pa of the vehicle file may be of "
                                        "another place",
                                        median, air)));
    } else if (median < 0.8 * air) {
      checkReading(median);
    } else if (const double depth_m = depthOf(median); depth_m > vehicle_.limits.depth_m) {
      findings_.push_back(
          finding("depth", Depth::label, instance_, likely,
                  print("%.6g Pa are %.4g m of water; limits: depth_m of the vehicle file is %.4g", median,
                        depth_m, vehicle_.limits.depth_m)));
    }
  }

 private:
  double depthOf(double pressure_pa) const { return fathom::depthOf(pressure_pa, vehicle_, instance_); }

  void checkReading(double median) {
    Finding found = finding("pressure-below-air", Depth::label, instance_, sure,
                            print("the pressure is %.6g Pa, %.4g of the air's %.6g", median,
                                  median / sheet_.atmospheric_pressure_pa, sheet_.atmospheric_pressure_pa));
    const double least = leastReading();
    std::vector<std::pair<double, const PressureUnit*>> units;
    for (const PressureUnit& unit : pressureUnits()) units.emplace_back(badness(unit, median, least), &unit);
    std::stable_sort(units.begin(), units.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    const PressureUnit& best = *units[0].second;
    if (units[0].first > kNoTelling + 3) {
      found.what += "; no usual unit explains it";
    } else if (units[1].first < units[0].first + kClear && !isItsGauge(*units[1].second, best)) {
      found.what += "; which unit it has is not told:";
      for (std::size_t i = 0; i < 4 && units[i].first < units[0].first + kClear; ++i)
        found.what += print("%s --correct %s makes it %.4g m of water", i == 0 ? "" : ",",
                            units[i].second->name, depthBy(*units[i].second, median));
    } else {
      found = finding(best.name, Depth::label, instance_, sure, found.what + "; " + best.says);
      found = correctable(found, print("%.6g Pa, %.4g m of water",
                                       inPascal(median, best, vehicle_, instance_), depthBy(best, median)));
      if (const PressureUnit& other = *units[1].second;
          units[1].first < units[0].first + kClear && isItsGauge(other, best))
        found.what += print(", or of a gauge, which is not told: --correct %s makes it %.4g m", other.name,
                            depthBy(other, median));
    }
    findings_.push_back(found);
  }
  /// Far from the surface they read alike, and most are absolute (as the messages of ROS are).
  static bool isItsGauge(const PressureUnit& unit, const PressureUnit& absolute) {
    return unit.pa == absolute.pa && unit.from == PressureUnit::From::air && absolute.from != unit.from;
  }
  double depthBy(const PressureUnit& unit, double reading) const {
    return depthOf(inPascal(reading, unit, vehicle_, instance_));
  }

  static constexpr double kImpossible = 1e6, kNoTelling = 3, kClear = 0.5;
  /// Less is better. By how far the DVL's way up and down is from the pressure's, where both move, in which
  /// a third more or less is as good as refuted; or else by how far the noise is from the vehicle file's, and
  /// whether it is a depth that one dives to. Of equals the more usual.
  double badness(const PressureUnit& unit, double median, double least) const {
    const double depth_m = depthBy(unit, median);
    if (depth_m < -0.5 || depthBy(unit, least) < -1 || depth_m > vehicle_.limits.depth_m) return kImpossible;
    // A gauge that is in Pa is usual; in other units it reads like an absolute one of ten metres less: where
    // that came near the surface it was absolute.
    const bool other_gauge = unit.from == PressureUnit::From::air && unit.pa != 1;
    const double absolute_m = depthOf(unit.pa * least);
    const double gauge = !other_gauge ? 0 : absolute_m > -0.5 && absolute_m < 2 ? 1 : 0.3;
    const double how_usual = 0.01 * static_cast<double>(&unit - pressureUnits().data()) + gauge;
    const double each_pa = pascalsEach(unit, vehicle_, instance_);
    // The same slope is a gauge's too, or a metre's and a decibar's: then what is usual, and dived to.
    const double unlikely = (depth_m < 0.3 ? 2 : 0) + how_usual;
    if (vertical_ok_) {
      const double ratio = vertical_.slope() * each_pa;  // 1 where it is right
      if (ratio < 1 / 1.3 || ratio > 1.3) return kImpossible;
      return unlikely;
    }
    if (each_pa < 0) return kImpossible;
    const double noise = std::abs(std::log(noiseOfReadings() * each_pa / sheet_.pressure_sigma_pa));
    return std::min(noise, kNoTelling) + unlikely;
  }

  /// Of the least deep, outliers apart.
  double leastReading() const {
    std::vector<double> all;
    for (const auto& reading : stream_.pressures) all.push_back(reading.value);
    const auto at = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 50);
    std::nth_element(all.begin(), at, all.end());
    return *at;
  }

  /// Of what is no motion: second differences (von Neumann's way; sum of squares of 1, -2, 1 is 6).
  double noiseOfReadings() const {
    std::vector<double> seconds;
    const auto& p = stream_.pressures;
    for (std::size_t i = 2; i < p.size(); ++i)
      seconds.push_back(std::abs(p[i].value - 2 * p[i - 1].value + p[i - 2].value));
    return sigmaByMedian(seconds) / std::sqrt(6.0);
  }

  const Instance instance_;
  const DepthStream& stream_;
  const Vehicle& vehicle_;
  const DepthSheet& sheet_;
  const Regression& vertical_;  ///< of the pressure's way up over the DVL's
  std::vector<Finding>& findings_;
  const bool vertical_ok_ = (vertical_.count() >= 10 && std::abs(vertical_.correlation()) > 0.8) ||
                            (vertical_.count() >= 4 && std::abs(vertical_.correlation()) > 0.95);
};

}  // namespace

void checkDepth(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings) {
  for (const auto& [instance, stream] : streams.depth)
    DepthCheck(instance, stream, vehicle, verticalEvidence(streams, stream, vehicle, findings), findings)
        .check();
}

}  // namespace fathom
