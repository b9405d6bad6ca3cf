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
// Of units that are near each other all are named where the best is no better than that.
constexpr double kNearUnits = 10;
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
         a.dvl_later_s == b.dvl_later_s && a.ins_later_s == b.ins_later_s && a.rise == b.rise &&
         attitude(a).isApprox(attitude(b), 0.05);
}

/// Of a multiple of one; 1 otherwise.
double unitOf(const Matrix3d& axes) {
  return axes.isApprox(axes(0, 0) * Matrix3d::Identity()) && axes(0, 0) > 0 ? axes(0, 0) : 1;
}

/// A DVL in feet a second or km/h, knots or miles an hour: scale errors and noise of ten per cent and more do
/// not tell them apart, though the smaller one leaves less.
bool areNearUnits(const Assumption& a, const Assumption& b) {
  constexpr double kNear = 1.3;
  const double unit_a = unitOf(a.dvl), unit_b = unitOf(b.dvl);
  if (unit_a == 1 || unit_b == 1) return false;
  return unit_a < kNear * unit_b && unit_b < kNear * unit_a;
}

/// Of the instrument that is compared in a relation; 1 where it is no smaller one.
double smallerUnit(std::size_t relation, const Assumption& taken_for) {
  switch (relation) {
    case Agreement::kTurning:
    case Agreement::kGravity:
      return std::min(1.0, unitOf(taken_for.gyro));
    case Agreement::kVelocity:
    case Agreement::kRise:
      return std::min(1.0, unitOf(taken_for.dvl));
    default:
      return 1;
  }
}

/// Of an instrument that is in another unit, where what is compared goes along with each other: by how much
/// more likely its ratio becomes, whose logarithm ordinary scale errors and noise of either side (which of
/// them has it is not known: between the one regression's slope and the other's) leave so uncertain. Heavy
/// tails, as of the differences; of two that are far off the nearer is the better. Nothing where they do not
/// go along.
std::optional<double> unitGain(const Regression& regression, double unit, double weight) {
  constexpr double kScaleErrors = 0.08, kLeastCorrelation = 0.6;
  const double correlation = regression.correlation();
  if (correlation < kLeastCorrelation || regression.rmsX() <= 0) return {};
  const double ratio = regression.rmsY() / regression.rmsX(), sigma = kScaleErrors - std::log(correlation);
  const auto off = [&](double r) {
    return weight * std::log1p(0.5 * std::pow(std::log(r) / sigma, 2) / weight);
  };
  return off(ratio) - off(ratio * unit);
}

std::optional<double> unitGain(const Agreement& agreement, Agreement::Relation relation,
                               const Assumption& taken_for) {
  const double weight = agreement.asTheyStand()[relation].weight;
  const Regression& regression = agreement.regression(relation);
  if (relation == Agreement::kVelocity) return unitGain(regression, unitOf(taken_for.dvl), weight);
  if (relation == Agreement::kRise) return unitGain(regression, 1 / unitOf(taken_for.dvl), weight);
  if (relation == Agreement::kTurning) return unitGain(regression, 1 / unitOf(taken_for.gyro), weight);
  return {};
}

/// The gain of each relation. A smaller unit makes noise and whatever else differs smaller, too. So it is
/// judged by what goes along with each other, or in the unit that was read: what is then less than ordinary
/// differences are says nothing for it, and against it only what grows.
std::array<double, Agreement::kRelations> gainsOf(const Agreement& agreement,
                                                  const Agreement::Differences& after,
                                                  const Assumption& taken_for) {
  const Agreement::Differences& before = agreement.asTheyStand();
  std::array<double, Agreement::kRelations> gains{};
  for (std::size_t r = 0; r < gains.size(); ++r) {
    if (before[r].weight == 0) continue;
    const double read = std::pow(smallerUnit(r, taken_for), 2), was = before[r].square + before[r].floor;
    const double less = before[r].weight * std::log(was * read / (after[r].square + after[r].floor));
    gains[r] = less;
    if (read == 1) continue;
    const double more = std::max(0.0, after[r].square - after[r].floor) / read + before[r].floor;
    const double by_differences = std::max(less, std::min(0.0, before[r].weight * std::log(was / more)));
    gains[r] = unitGain(agreement, static_cast<Agreement::Relation>(r), taken_for).value_or(by_differences);
  }
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
                     [](const Explanation& a, const Explanation& b) { return rank(a) > rank(b); });
    if (all_.empty() || all_[0].gain < kLikelyGain || all_[0].largest_ratio < kLikelyRatio) return {};
    const double rank_of_best = rank(all_[0]);
    std::vector<Explanation> best;
    for (Explanation& e : all_) {
      const bool known = std::any_of(best.begin(), best.end(), [&](const Explanation& other) {
        return !areTheSame(e.fault.taken_for, {}, R_robot_ins_) &&
               areTheSame(e.fault.taken_for, other.fault.taken_for, R_robot_ins_);
      });
      const bool as_good = rank(e) >= rank_of_best - kClear ||
                           (!best.empty() && areNearUnits(e.fault.taken_for, best[0].fault.taken_for) &&
                            e.gain >= best[0].gain - kNearUnits);
      if (as_good && !known) best.push_back(std::move(e));
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
    bool leaves_little = true;
    for (std::size_t r = 0; r < Agreement::kRelations; ++r) {
      if (before[r].weight == 0) continue;
      const bool agrees = agreesNow(r, e.differences[r], e.fault.taken_for);
      e.agrees = e.agrees && agrees;
      if (r == Agreement::kUpright) continue;
      // What is right makes nothing disagree that agreed.
      if (!agrees && e.gains[r] < 0 && agreesNow(r, before[r], {})) return;
      if (e.gains[r] > 0)
        e.largest_ratio = std::max({e.largest_ratio, ratioOf(r, e), std::exp(e.gains[r] / before[r].weight)});
      // Accelerations turn the specific force as much as the robot's own turning does.
      const double usual = r == Agreement::kGravity ? 1 : 0.25;
      const double most_left = std::max(usual * before[r].moves, 4 * e.differences[r].floor);
      if (e.gains[r] != 0 && e.differences[r].square - noiseIn(r, e.fault.taken_for) > most_left)
        leaves_little = false;
    }
    e.agrees = e.agrees && leaves_little;
    const bool clock = e.fault.taken_for.dvl_later_s != e.fault.taken_for.ins_later_s;
    if (clock && e.gains[Agreement::kVelocity] < kLikelyGain) return;  // the rise only tells whose it is
    // A smaller unit leaves less of a gyro that is wrong otherwise.
    if (unitOf(e.fault.taken_for.gyro) != 1) {
      if (!leaves_little) return;
      if (!tellsMoreThanNoGyro(e)) e.agrees = false;
    }
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
      Agreement::Differences differences = agreement_.asTheyStand();  // floors and all
      for (std::size_t r = 0; r < differences.size(); ++r) {
        differences[r].square = other.asTheyStand()[r].square;
        differences[r].with_biases = other.asTheyStand()[r].with_biases;
      }
      add(std::move(fault), differences);
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
    const auto angle_rad = agreement_.bestTurn();
    if (!angle_rad) return;
    const double angle_deg = std::round(degrees(*angle_rad));
    if (std::abs(std::remainder(angle_deg, 90)) < 10) return;
    DriverFault turned;
    turned.parts.push_back({print("dvl-turned:%.0f", angle_deg),
                            print("it is turned by %.0f deg about its z axis", -angle_deg),
                            "agree with the others"});
    turned.taken_for.dvl = rotationFromYawPitchRoll(radians(angle_deg), 0, 0);
    turned.unusual = kUnusualNumber;
    consider(std::move(turned));
  }

  void considerClocks() {
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
    // By the two of them alone it is either clock; the pressure may tell.
    const auto late = [&](const char* label, const char* whose, double later_s) {
      DriverFault fault;
      fault.parts.push_back(
          {print("clock-offset:%s:%.2f", label, later_s),
           print("%s stamps are %.2f s too %s", whose, std::abs(later_s), later_s > 0 ? "early" : "late"),
           print("%.2f s %s", std::abs(later_s), later_s > 0 ? "later" : "earlier")});
      fault.unusual = kUnusualNumber;
      return fault;
    };
    DriverFault dvl = late("DVL", "the DVL's", best_s), ins = late("INS", "the INS's", -best_s);
    dvl.taken_for.dvl_later_s = best_s;
    ins.taken_for.ins_later_s = -best_s;
    consider(std::move(dvl)), consider(std::move(ins));
  }

 private:
  static constexpr double kLeastUnusual = 5, kUnusualNumber = 6;

  /// What leaves a disagreement needs another fault beside it.
  static double rank(const Explanation& e) {
    constexpr double kAnotherFault = 30;
    return e.gain - (e.agrees ? 0 : kAnotherFault);
  }

  /// As healthy streams do.
  bool agreesNow(std::size_t relation, const Agreement::Difference& now, const Assumption& taken_for) const {
    // Accelerations turn the specific force as much as the robot's own turning does.
    const double usual = relation == Agreement::kGravity ? 1 : relation == Agreement::kUpright ? 0 : 0.04;
    return now.square - noiseIn(relation, taken_for) <= std::max(usual * now.moves, 4 * now.floor);
  }

  /// Of a relation's square: white noise of readings, which becomes smaller with their unit.
  double noiseIn(std::size_t relation, const Assumption& taken_for) const {
    const double read = relation == Agreement::kVelocity ? smallerUnit(relation, taken_for) : 1;
    return read * read * agreement_.noiseSquare(static_cast<Agreement::Relation>(relation));
  }

  /// Of a gyro in another unit: whether what it then reads explains anything.
  bool tellsMoreThanNoGyro(const Explanation& e) {
    if (e.gains[Agreement::kTurning] > kClear) return true;
    if (!without_gyro_) {
      Assumption none;
      none.gyro.setZero();
      without_gyro_ = gainsOf(agreement_, agreement_.of(none), none);
    }
    const auto gain = [](const auto& gains) {
      return gains[Agreement::kGravity] + gains[Agreement::kVelocity];
    };
    return gain(e.gains) > gain(*without_gyro_) + kClear;
  }

  /// Of squares, before and after, beyond what is noise in both; with biases or without, where they are
  /// more than instruments have.
  double ratioOf(std::size_t relation, const Explanation& e) const {
    const Agreement::Difference &before = agreement_.asTheyStand()[relation],
                                &after = e.differences[relation];
    const double unit_square = std::pow(smallerUnit(relation, e.fault.taken_for), 2);
    const double noise =
        relation == Agreement::kVelocity
            ? std::min(agreement_.noiseSquare(Agreement::kVelocity), after.square / unit_square)
            : 0;
    const auto ratio = [&](double was, double is) {
      return (was + before.floor - noise) / ((is + after.floor) / unit_square - noise);
    };
    return std::max(ratio(before.square, after.square), ratio(before.with_biases, after.with_biases));
  }

  const Agreement& agreement_;
  const Matrix3d R_robot_ins_;
  std::vector<DriverFault> faults_;
  std::vector<Explanation> all_;
  std::optional<std::array<double, Agreement::kRelations>> without_gyro_;
};

}  // namespace

bool Explanation::isSure() const {
  const double offset_s = std::abs(fault.taken_for.dvl_later_s - fault.taken_for.ins_later_s);
  return witnessed > kSureGain && largest_ratio > kSureRatio && agrees &&
         (offset_s == 0 || offset_s > kSureOffset_s);
}

std::vector<Explanation> explanationsOf(ExplanationSearch search) {
  Explainer explainer(search.agreement, search.ins.T_robot_ins.rotation, std::move(search.faults));
  if (!explainer.mayExplain()) return {};
  if (search.vectors_in_world) explainer.considerInWorld(search.ins, search.dvl, search.agreementOf);
  if (search.dvl != nullptr && search.dvl_turned) explainer.considerDvlTurned();
  if (search.dvl != nullptr && search.clock_off) explainer.considerClocks();
  return explainer.explanations();
}

}  // namespace fathom
