#include <algorithm>
#include <cmath>

#include "audit/checks.h"
#include "audit/explanation.h"
#include "core/median.h"
#include "core/text.h"

namespace fathom {
namespace {
using enum Finding::Certainty;

// ---- in words

constexpr std::size_t kMostSaid = 6;  // of what is not told apart
constexpr const char* kSomethingElse = "; something else is wrong, too";

/// Of the relation that tells most.
std::string whatDiffers(const Agreement::Differences& before, const Explanation& e) {
  const auto most =
      static_cast<std::size_t>(std::max_element(e.gains.begin(), e.gains.end()) - e.gains.begin());
  const double was = before[most].rms(), is = e.differences[most].rms();
  switch (static_cast<Agreement::Relation>(most)) {
    case Agreement::kUp:
      return print("up by the attitude is %.3g deg off the specific force, %.3g", degrees(was), degrees(is));
    case Agreement::kTurning:
      return print("the attitude turns by %.3g deg/s otherwise than the gyro says, %.3g", degrees(was),
                   degrees(is));
    case Agreement::kGravity:
      return print("gravity turns by %.3g deg/s otherwise than the gyro says, %.3g", degrees(was),
                   degrees(is));
    case Agreement::kVelocity:
      return print("the DVL's velocity changes by %.3g m/s otherwise than the INS's acceleration makes, %.3g",
                   was, is);
    case Agreement::kRise:
      return print("in %.0f s it rises by %.3g m otherwise by the pressure than by the DVL, %.3g",
                   kVerticalStep_s, was, is);
    default:
      return print("the specific force points %.3g deg off the robot's up, %.3g", degrees(was), degrees(is));
  }
}

std::string instanceCorrection(const std::string& correction, const Instance& instance) {
  const std::size_t colon = correction.find(':');
  if (correction.starts_with("clock-offset:INS:")) return correction;
  if (correction.starts_with("clock-offset:DVL:"))
    return "clock-offset:" + instance.label("DVL") + correction.substr(correction.rfind(':'));
  return instance.label(correction.substr(0, colon)) +
         (colon == std::string::npos ? "" : correction.substr(colon));
}

/// Whose entries a correction concerns.
const char* labelOf(const std::string& correction) {
  if (correction.starts_with("dvl") || correction.starts_with("clock-offset:DVL")) return Dvl::label;
  return correction.starts_with("pressure") ? Depth::label : Ins::label;
}

std::string saysAll(const DriverFault& fault, const Instance& instance) {
  std::string text;
  for (const DriverFault::Part& part : fault.parts) {
    text += (text.empty() ? "" : " and ") + part.says;
    if (!part.corrected.empty()) text += " (--correct " + instanceCorrection(part.correction, instance) + ")";
  }
  return text;
}

void say(const std::vector<Explanation>& explanations, const Agreement::Differences& before,
         const Instance& instance, std::vector<Finding>& findings) {
  if (explanations.empty()) return;
  const Explanation& best = explanations[0];
  const std::string what = whatDiffers(before, best);
  for (const DriverFault::Part& part : best.fault.parts) {
    const bool clock = part.correction.starts_with("clock-offset");
    const std::string name =
        part.correction.substr(0, clock ? part.correction.rfind(':') : part.correction.find(':'));
    Finding found =
        finding(name, labelOf(name), instance, best.isSure() ? sure : likely, what + " if " + part.says);
    if (explanations.size() > 1) {
      found.what = what + " at best; which is not told: ";
      for (std::size_t k = 0; k < explanations.size() && k < kMostSaid; ++k)
        found.what += (k == 0 ? "" : ", or ") + saysAll(explanations[k].fault, instance);
      if (explanations.size() > kMostSaid)
        found.what += print(", or %zu others", explanations.size() - kMostSaid);
      if (!best.agrees) found.what += kSomethingElse;
      findings.push_back(found);
      return;
    }
    if (!part.corrected.empty()) {
      found = correctable(found, part.corrected);
      found.correction = instanceCorrection(part.correction, instance);
    }
    if (!best.agrees) found.what += kSomethingElse;
    findings.push_back(found);
  }
}

// ---- which with which

/// To m/s²: by gravity's length; 0 where the accelerometer is found not to read it.
double forceScale(const InsStream& stream, const Vehicle& vehicle, const Instance& instance,
                  const std::vector<Finding>& findings) {
  for (const Finding& f : findings)
    for (const char* name : {"accelerometer-without-gravity", "accelerometer-zero", "gravity-length"})
      if (f.name == instance.label(name)) return 0;
  std::vector<double> lengths;
  for (const InsWindow& w : stream.windows)
    if (w.forces > 0) lengths.push_back(w.force.norm());
  if (lengths.size() < 10 * kFewestSeconds || vehicle.gravity_m_s2 <= 0) return 0;
  const double length = upperMedian(lengths);
  return length > 0 ? vehicle.gravity_m_s2 / length : 0;
}

bool hasAttitude(const InsStream& stream) {
  return std::any_of(stream.windows.begin(), stream.windows.end(),
                     [](const InsWindow& w) { return w.attitude.has_value(); });
}

/// What goes along with another but is so much more or less that no usual unit explains it.
void checkScales(const Agreement& agreement, const Instance& instance, std::vector<Finding>& findings) {
  struct Scale {
    Agreement::Relation relation;
    const char *name, *label, *what;
  };
  for (const Scale& scale : {Scale{Agreement::kTurning, "gyro-scale-far-off", Ins::label,
                                   "the attitude turns by %.4g of what the gyro says"},
                             Scale{Agreement::kVelocity, "dvl-scale-far-off", Dvl::label,
                                   "its velocity changes by %.4g of what the INS's acceleration makes"},
                             Scale{Agreement::kRise, "dvl-up-and-down", Dvl::label,
                                   "the pressure falls by %.4g of how the DVL rises"}}) {
    const Regression& r = agreement.regression(scale.relation);
    if (r.count() < 10 || std::abs(r.correlation()) < 0.8 || isNear(r.slope(), 1, 0.4)) continue;
    findings.push_back(finding(scale.name, scale.label, instance, likely, print(scale.what, r.slope())));
  }
}

bool isOfInertial(const DriverFault& fault) {
  return std::string_view(labelOf(fault.parts[0].correction)) == Ins::label;
}

}  // namespace

void checkAgreement(const Streams& streams, const Vehicle& vehicle, bool clocks_agree,
                    std::vector<Finding>& findings) {
  const DepthStream* depth = streams.depth.empty() ? nullptr : &streams.depth.begin()->second;
  if (hasFinding(findings, Depth::label, {})) depth = nullptr;
  // What is tried: faults of the INS, of the DVL and the pressure sensor, or of all.
  enum class Tried { ins, others, all };
  const auto compare = [&](const Instance& instance, const DvlStream* dvl, const Instance& of, Tried tried) {
    const InsStream& ins = streams.ins.at(instance);
    for (const char* useless :
         {"gyro-frozen", "gyro-repeated", "accelerometer-frozen", "accelerometer-repeated"})
      if (isFound(findings, useless, instance)) return;
    const bool with_attitude = hasAttitude(ins) && !isFound(findings, "attitude-constant", instance) &&
                               !isFound(findings, "attitude-frozen", instance);
    const double force_scale = forceScale(ins, vehicle, instance, findings);
    const auto agreementOf = [&](const InsStream& an_ins, const DvlStream* a_dvl) {
      return Agreement(an_ins, sheetOf<Ins>(vehicle, instance), with_attitude, a_dvl, depth, vehicle,
                       force_scale);
    };
    const Agreement agreement = agreementOf(ins, dvl);
    std::vector<DriverFault> faults =
        driverFaults(with_attitude, dvl != nullptr, depth != nullptr, ins.T_robot_ins.rotation);
    std::erase_if(faults, [&](const DriverFault& fault) {
      return tried != Tried::all && isOfInertial(fault) != (tried == Tried::ins);
    });
    const bool others_too = tried != Tried::ins;
    const std::vector<Explanation> explanations =
        explanationsOf({agreement, ins, dvl, std::move(faults), with_attitude && tried == Tried::all,
                        others_too, others_too && clocks_agree, agreementOf});
    say(explanations, agreement.asTheyStand(), of, findings);
    if (explanations.empty()) checkScales(agreement, of, findings);
  };
  const DvlStream* first_dvl =
      streams.dvl.empty() || hasFinding(findings, Dvl::label, {}) ? nullptr : &streams.dvl.begin()->second;
  bool is_first = true;
  for (const auto& entry : streams.ins) {
    compare(entry.first, first_dvl, entry.first, is_first ? Tried::all : Tried::ins);
    is_first = false;
  }
  if (streams.ins.empty() || hasFinding(findings, Ins::label, streams.ins.begin()->first)) return;
  for (const auto& entry : streams.dvl)
    if (&entry.second != &streams.dvl.begin()->second)
      compare(streams.ins.begin()->first, &entry.second, entry.first, Tried::others);
}

}  // namespace fathom
