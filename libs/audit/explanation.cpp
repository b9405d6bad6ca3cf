#include "audit/explanation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "audit/attitude_conventions.h"
#include "core/text.h"

namespace fathom {
namespace {

// Of the gain in log likelihood, priors included, and of the ratio of squares: less is silence; a sure one
// needs more, and a relation whose difference becomes half of what it was; within kClear of the best nothing
// is told apart.
constexpr double kLikelyGain = 8, kLikelyRatio = 1.7, kSureGain = 20, kSureRatio = 4, kClear = 3;
constexpr double kMostOffset_s = 5, kOffsetStep_s = 0.25, kFineOffset_s = 0.05;
// Instruments take up to a second and more for a reading, which is for diagnosis to find; clocks are off by
// any time.
constexpr double kLeastOffset_s = 0.5, kSureOffset_s = 1.5;

/// A velocity in a world's axes turned into the DVL's, by the attitude.
DvlStream outOfWorld(const DvlStream& dvl, const InsStream& ins, const Matrix3d& R_odom_world) {
  DvlStream turned{dvl.T_robot_dvl, {}};
  std::size_t next = 0;
  for (const auto& [t_s, velocity] : dvl.velocities) {
    while (next + 1 < ins.windows.size() && ins.windows[next + 1].t_s <= t_s) ++next;
    if (next >= ins.windows.size() || !ins.windows[next].attitude) continue;
    const Matrix3d R_odom_dvl =
        *ins.windows[next].attitude * ins.T_robot_ins.rotation.transpose() * dvl.T_robot_dvl.rotation;
    turned.velocities.push_back({t_s, R_odom_dvl.transpose() * R_odom_world * velocity});
  }
  return turned;
}

/// Whether two come to the same, whatever they are called.
bool areTheSame(const Assumption& a, const Assumption& b, const Matrix3d& R_robot_ins) {
  const auto attitude = [&](const Assumption& x) -> Matrix3d {
    return x.attitude->read(rotationFromYawPitchRoll(0.4, 0.3, 0.2) * x.attitude_axes.transpose(),
                            R_robot_ins);
  };
  return a.gyro.isApprox(b.gyro) && a.accelerometer.isApprox(b.accelerometer) && a.dvl.isApprox(b.dvl) &&
         a.dvl_later_s == b.dvl_later_s && a.rise == b.rise && attitude(a).isApprox(attitude(b), 0.05);
}

/// Of an instrument that is in another unit: by how much more likely its ratio to what it is compared with
/// becomes, whose logarithm ordinary scale errors and noise of either side (which of them has it is not
/// known: between the one regression's slope and the other's) leave so uncertain. Differences would not do: a
/// smaller unit makes noise smaller, too.
double unitGain(const Regression& regression, double unit) {
  constexpr double kScaleErrors = 0.08, kLeastCorrelation = 0.6, kMost = 120;
  const double correlation = regression.correlation();
  if (correlation < kLeastCorrelation || regression.rmsX() <= 0) return 0;
  const double ratio = regression.rmsY() / regression.rmsX();
  const double sigma = kScaleErrors - std::log(correlation);
  const auto off = [&](double r) { return 0.5 * std::pow(std::log(r) / sigma, 2); };
  return std::clamp(off(ratio) - off(ratio * unit), -kMost, kMost);
}

/// Of a multiple of one; 1 otherwise.
double unitOf(const Matrix3d& axes) {
  return axes.isApprox(axes(0, 0) * Matrix3d::Identity()) && axes(0, 0) > 0 ? axes(0, 0) : 1;
}

/// The gain of each relation.
std::array<double, Agreement::kRelations> gainsOf(const Agreement& agreement,
                                                  const Agreement::Differences& after,
                                                  const Assumption& taken_for) {
  const Agreement::Differences& before = agreement.asTheyStand();
  std::array<double, Agreement::kRelations> gains{};
  for (std::size_t r = 0; r < gains.size(); ++r)
    if (before[r].weight > 0)
      gains[r] = before[r].weight *
                 std::log((before[r].square + before[r].floor) / (after[r].square + before[r].floor));
  const auto weighed = [&](Agreement::Relation r, double unit) {
    if (before[r].weight > 0) gains[r] = unitGain(agreement.regression(r), unit);
  };
  if (const double unit = unitOf(taken_for.dvl); unit != 1) {
    weighed(Agreement::kVelocity, unit);
    weighed(Agreement::kRise, 1 / unit);
  }
  if (const double unit = unitOf(taken_for.gyro); unit != 1) weighed(Agreement::kTurning, 1 / unit);
  return gains;
}

class Explainer {
 public:
  Explainer(const Agreement& agreement, const Matrix3d& R_robot_ins, std::vector<DriverFault> faults)
      : agreement_(agreement), R_robot_ins_(R_robot_ins), faults_(std::move(faults)) {}

  /// Whether anything could be enough better than no fault: if all differences vanished.
  bool mayExplain() const {
    double most = 0;
    for (const Agreement::Difference& d : agreement_.asTheyStand())
      if (d.weight > 0) most += d.weight * std::log((d.square + d.floor) / d.floor);
    return most >= kLikelyGain + kLeastUnusual;
  }

  /// The best and those that are as good, best first; none where nothing is better enough than no fault.
  std::vector<Explanation> explanations() {
    for (DriverFault& fault : faults_) consider(std::move(fault));
    std::stable_sort(all_.begin(), all_.end(),
                     [](const Explanation& a, const Explanation& b) { return a.gain > b.gain; });
    if (all_.empty() || all_[0].gain < kLikelyGain || all_[0].largest_ratio < kLikelyRatio) return {};
    std::vector<Explanation> best;
    for (Explanation& e : all_) {
      const bool known = std::any_of(best.begin(), best.end(), [&](const Explanation& other) {
        return !areTheSame(e.fault.taken_for, {}, R_robot_ins_) &&
               areTheSame(e.fault.taken_for, other.fault.taken_for, R_robot_ins_);
      });
      if (e.gain >= all_[0].gain - kClear && !known) best.push_back(std::move(e));
    }
    return best;
  }

  void consider(DriverFault fault) {
    const Agreement::Differences differences = agreement_.of(fault.taken_for);
    add(std::move(fault), differences);
  }

  void add(DriverFault fault, const Agreement::Differences& differences) {
    Explanation e{std::move(fault), differences};
    const Agreement::Differences& before = agreement_.asTheyStand();
    e.gains = gainsOf(agreement_, e.differences, e.fault.taken_for);
    e.gain = std::accumulate(e.gains.begin(), e.gains.end(), -e.fault.unusual);
    e.witnessed = e.gain + e.fault.unusual - e.gains[Agreement::kUpright];
    for (std::size_t r = 0; r < Agreement::kUpright; ++r) {
      if (before[r].weight == 0) continue;
      if (e.gains[r] > 0) e.largest_ratio = std::max(e.largest_ratio, ratioOf(r, e));
      // Accelerations turn the specific force as much as the robot's own turning does.
      const double usual = r == Agreement::kGravity ? 1 : 0.25;
      const double most_left = std::max(usual * before[r].moves, 4 * before[r].floor);
      if (e.gains[r] != 0 && e.differences[r].square > most_left) e.leaves_little = false;
    }
    // A smaller unit leaves less of a gyro that is wrong otherwise.
    if (unitOf(e.fault.taken_for.gyro) != 1 && !e.leaves_little) return;
    all_.push_back(std::move(e));
  }

  /// Vectors that a driver has turned into the world.
  void considerInWorld(const InsStream& ins, const DvlStream* dvl,
                       const std::function<Agreement(const InsStream&, const DvlStream*)>& agreementOf) {
    const auto consider = [&](const char* name, const char* says, const char* corrected,
                              const Agreement& other) {
      DriverFault fault;
      fault.parts.push_back({name, says, corrected});
      fault.unusual = kUnusualNumber;
      add(std::move(fault), other.asTheyStand());
    };
    InsStream force = ins, rate = ins;
    for (InsWindow& w : force.windows)
      if (w.attitude) w.force = w.attitude->transpose() * w.force;
    for (InsWindow& w : rate.windows)
      if (w.attitude) w.rate = w.attitude->transpose() * w.rate;
    consider("accelerometer-in-world", "the accelerometer's vector is in the world's axes", "in its own",
             agreementOf(force, dvl));
    consider("gyro-in-world", "the gyro's vector is in the world's axes", "in its own",
             agreementOf(rate, dvl));
    if (dvl == nullptr) return;
    const DvlStream east = outOfWorld(*dvl, ins, Matrix3d::Identity()),
                    north = outOfWorld(*dvl, ins, enuFromNed());
    consider("dvl-in-world", "its velocity is in the world's axes", "", agreementOf(ins, &east));
    consider("dvl-in-world-ned", "its velocity is north, east, down", "", agreementOf(ins, &north));
  }

  /// A DVL at any angle about its z axis; right ones are among the axes.
  void considerDvlTurned() {
    const auto turn = agreement_.bestTurn();
    if (!turn) return;
    const double angle_deg = std::round(degrees(turn->angle_rad) * 10) / 10;
    if (std::abs(std::remainder(angle_deg, 90)) < 10) return;
    DriverFault turned;
    turned.parts.push_back({print("dvl-turned:%.1f", angle_deg),
                            print("it is turned by %.1f deg about its z axis", -angle_deg),
                            "agree with the others"});
    turned.taken_for.dvl = rotationFromYawPitchRoll(radians(angle_deg), 0, 0);
    turned.unusual = kUnusualNumber;
    consider(std::move(turned));
  }

  void considerDvlLate() {
    if (agreement_.asTheyStand()[Agreement::kVelocity].weight == 0) return;
    double best_s = 0, least = agreement_.asTheyStand()[Agreement::kVelocity].square;
    const auto look = [&](double around_s, double most_s, double step_s) {
      for (double s = around_s - most_s; s < around_s + most_s + step_s / 2; s += step_s) {
        Assumption later;
        later.dvl_later_s = s;
        const double square = agreement_.of(later)[Agreement::kVelocity].square;
        if (square < least) least = square, best_s = s;
      }
    };
    look(0, kMostOffset_s, kOffsetStep_s);
    look(best_s, kOffsetStep_s, kFineOffset_s);
    if (std::abs(best_s) < kLeastOffset_s) return;
    DriverFault late;
    late.parts.push_back(
        {print("clock-offset:DVL:%.2f", best_s),
         print("its stamps are %.2f s too %s", std::abs(best_s), best_s > 0 ? "early" : "late"),
         print("%.2f s %s", std::abs(best_s), best_s > 0 ? "later" : "earlier")});
    late.taken_for.dvl_later_s = best_s;
    late.unusual = kUnusualNumber;
    consider(std::move(late));
  }

 private:
  static constexpr double kLeastUnusual = 5, kUnusualNumber = 6;

  /// Of squares, before and after, beyond what is noise in both.
  double ratioOf(std::size_t relation, const Explanation& e) const {
    const Agreement::Difference& before = agreement_.asTheyStand()[relation];
    const double after = e.differences[relation].square;
    const double noise = relation == Agreement::kVelocity ? std::min(agreement_.dvlNoiseSquare(), after) : 0;
    return (before.square + before.floor - noise) / (after + before.floor - noise);
  }

  const Agreement& agreement_;
  const Matrix3d R_robot_ins_;
  std::vector<DriverFault> faults_;
  std::vector<Explanation> all_;
};

}  // namespace

bool Explanation::isSure() const {
  const double offset_s = std::abs(fault.taken_for.dvl_later_s);
  return witnessed > kSureGain && largest_ratio > kSureRatio && leaves_little &&
         (offset_s == 0 || offset_s > kSureOffset_s);
}

std::vector<Explanation> explanationsOf(ExplanationSearch search) {
  Explainer explainer(search.agreement, search.ins.T_robot_ins.rotation, std::move(search.faults));
  if (!explainer.mayExplain()) return {};
  if (search.vectors_in_world) explainer.considerInWorld(search.ins, search.dvl, search.agreementOf);
  if (search.dvl != nullptr && search.dvl_turned) explainer.considerDvlTurned();
  if (search.dvl != nullptr && search.dvl_late) explainer.considerDvlLate();
  return explainer.explanations();
}

}  // namespace fathom
