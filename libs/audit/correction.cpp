#include "audit/correction.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "audit/attitude_evidence.h"
#include "audit/sensor_units.h"
#include "audit/water_column.h"
#include "core/error.h"

namespace fathom {
namespace {

SignedAxes axesOf(const std::string& text, const std::string& whole) {
  SignedAxes axes;
  std::array<bool, 3> used{};
  std::size_t axis = 0, at = 0;
  const auto fail = [&] { return Error("--correct", whole, "behind the colon must be axes, as x,-y,-z"); };
  for (; axis < 3; ++axis, ++at) {
    axes.sign[axis] = at < text.size() && text[at] == '-' ? (++at, -1) : 1;
    if (at >= text.size() || text[at] < 'x' || text[at] > 'z') throw fail();
    axes.source[axis] = text[at] - 'x';
    if (std::exchange(used[static_cast<std::size_t>(axes.source[axis])], true)) throw fail();
    if (++at < text.size() && text[at] != ',') throw fail();
  }
  if (at != text.size() + 1) throw fail();
  return axes;
}

std::optional<double> numberOf(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  return text.empty() || *end != '\0' || !std::isfinite(number) ? std::nullopt : std::optional(number);
}

template <class Entry>
Entry& entryOf(Sample& sample) {
  return std::get<Entry>(sample.reading);
}

void turn(const Matrix3d& axes, std::optional<Vector3d>& vector) {
  if (vector) vector = Vector3d(axes * *vector);
}

/// What is at rest and so turned reads: gravity.
Vector3d forceAtRest(const InsSample& entry, const Vehicle& vehicle) {
  Inputs<double> rest;
  rest.world.gravity_odom = vehicle.gravityOdom();
  if (entry.R_odom_ins) rest.state.R_odom_robot = *entry.R_odom_ins * entry.T_robot_ins.rotation.transpose();
  return Accelerometer::specificForce(rest, Pose{entry.T_robot_ins.rotation, Vector3d::Zero()});
}

}  // namespace

std::string plainText(const SignedAxes& axes) {
  std::string text = axes.text();
  std::erase_if(text, [](char c) { return c == '(' || c == ')' || c == ' '; });
  return text;
}

struct Correction::Kind {
  const char* name;
  const char* label;
  bool has_axes;
  Apply apply;
  // Of one of several that differ by a number or a rotation only.
  double factor = 1;
  const AttitudeReading* reading{};
  const PressureUnit* unit{};
  bool has_angle = false;  ///< behind the colon, degrees
};

std::vector<Correction::Kind> Correction::makeKinds() {
  std::vector<Kind> all;
  const auto add = [&](const char* name, const char* label, Apply apply) {
    all.push_back({name, label, false, apply});
    return &all.back();
  };
  const auto addAxes = [&](const char* name, const char* label, Apply apply) {
    all.push_back({name, label, true, apply});
  };
  for (const SensorUnit& unit : kForceUnits)
    add(unit.name, Ins::label, [](const Correction& c, Sample& s, const Vehicle&) {
      if (auto& force = entryOf<InsSample>(s).specific_force_ins) *force *= c.factor_;
    })->factor = unit.si;
  add("accelerometer-without-gravity", Ins::label, [](const Correction&, Sample& s, const Vehicle& vehicle) {
    auto& entry = entryOf<InsSample>(s);
    if (entry.specific_force_ins) *entry.specific_force_ins += forceAtRest(entry, vehicle);
  });
  addAxes("accelerometer-axes", Ins::label, [](const Correction& c, Sample& s, const Vehicle&) {
    turn(c.axes_, entryOf<InsSample>(s).specific_force_ins);
  });
  for (const SensorUnit& unit : kRateUnits)
    add(unit.name, Ins::label, [](const Correction& c, Sample& s, const Vehicle&) {
      if (auto& rate = entryOf<InsSample>(s).angular_velocity_ins) *rate *= c.factor_;
    })->factor = unit.si;
  addAxes("gyro-axes", Ins::label, [](const Correction& c, Sample& s, const Vehicle&) {
    turn(c.axes_, entryOf<InsSample>(s).angular_velocity_ins);
  });
  add("accelerometer-in-world", Ins::label, [](const Correction&, Sample& s, const Vehicle&) {
    auto& entry = entryOf<InsSample>(s);
    if (entry.R_odom_ins) turn(entry.R_odom_ins->transpose(), entry.specific_force_ins);
  });
  add("gyro-in-world", Ins::label, [](const Correction&, Sample& s, const Vehicle&) {
    auto& entry = entryOf<InsSample>(s);
    if (entry.R_odom_ins) turn(entry.R_odom_ins->transpose(), entry.angular_velocity_ins);
  });
  addAxes("ins-axes", Ins::label, [](const Correction& c, Sample& s, const Vehicle&) {
    auto& entry = entryOf<InsSample>(s);
    turn(c.axes_, entry.specific_force_ins);
    turn(c.axes_, entry.angular_velocity_ins);
    if (entry.R_odom_ins) entry.R_odom_ins = Matrix3d(*entry.R_odom_ins * c.axes_.transpose());
  });
  for (const AttitudeReading& reading : attitudeReadings().subspan(1))  // the first is as it stands
    add(reading.name, Ins::label, [](const Correction& c, Sample& s, const Vehicle&) {
      auto& entry = entryOf<InsSample>(s);
      if (entry.R_odom_ins)
        entry.R_odom_ins = c.reading_->read(*entry.R_odom_ins, entry.T_robot_ins.rotation);
    })->reading = &reading;
  add("attitude-none", Ins::label,
      [](const Correction&, Sample& s, const Vehicle&) { entryOf<InsSample>(s).R_odom_ins.reset(); });
  for (const SensorUnit& unit : kVelocityUnits)
    add(unit.name, Dvl::label, [](const Correction& c, Sample& s, const Vehicle&) {
      if (auto& velocity = entryOf<DvlSample>(s).velocity_dvl) *velocity *= c.factor_;
    })->factor = unit.si;
  addAxes("dvl-axes", Dvl::label, [](const Correction& c, Sample& s, const Vehicle&) {
    turn(c.axes_, entryOf<DvlSample>(s).velocity_dvl);
  });
  add("dvl-turned", Dvl::label, [](const Correction& c, Sample& s, const Vehicle&) {
    turn(c.axes_, entryOf<DvlSample>(s).velocity_dvl);
  })->has_angle = true;
  for (const PressureUnit& unit : pressureUnits())
    add(unit.name, Depth::label, [](const Correction& c, Sample& s, const Vehicle& vehicle) {
      auto& p = entryOf<DepthSample>(s).pressure_pa;
      p = inPascal(p, *c.unit_, vehicle, Instance::of(c.label_));
    })->unit = &unit;
  return all;
}

const std::vector<Correction::Kind>& Correction::kinds() {
  static const std::vector<Kind> all = makeKinds();
  return all;
}

std::vector<std::string> Correction::names() {
  std::vector<std::string> names;
  for (const Kind& kind : kinds())
    names.push_back(std::string(kind.name) + (kind.has_axes ? ":AXES" : kind.has_angle ? ":DEGREES" : ""));
  names.emplace_back("clock-rate:LABEL:FACTOR");
  names.emplace_back("clock-offset:LABEL:SECONDS");
  return names;
}

Correction Correction::named(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon),
                    more = colon == std::string::npos ? "" : text.substr(colon + 1);
  Correction correction;
  if (name == "clock-rate" || name == "clock-offset") {
    const std::size_t second = more.rfind(':');
    correction.label_ = more.substr(0, second);
    const auto number = numberOf(second == std::string::npos ? "" : more.substr(second + 1));
    if (name == "clock-offset") {
      if (!number || std::abs(*number) > 1e6)
        throw Error("--correct", text, "must be clock-offset:LABEL:SECONDS, as clock-offset:DVL:-1.5");
      correction.clock_offset_s_ = *number;
      return correction;
    }
    if (!number || !(*number > 0.5 && *number < 2))
      throw Error("--correct", text, "must be clock-rate:LABEL:FACTOR, as clock-rate:INS:1.0025");
    correction.clock_factor_ = *number;
    return correction;
  }
  for (const Kind& kind : kinds()) {
    const auto instance = Instance::of(name, kind.name);
    if (!instance) continue;
    if (kind.has_angle) {
      const auto angle_deg = numberOf(more);
      if (!angle_deg) throw Error("--correct", text, "must be dvl-turned:DEGREES, as dvl-turned:45");
      correction.axes_ = rotationFromYawPitchRoll(radians(*angle_deg), 0, 0);
    } else if (!kind.has_axes && !more.empty())
      throw Error("--correct", text, "takes nothing behind a colon");
    if (kind.has_axes) correction.axes_ = axesOf(more, text).matrix();
    correction.apply_ = kind.apply;
    correction.factor_ = kind.factor;
    correction.reading_ = kind.reading;
    correction.unit_ = kind.unit;
    correction.label_ = instance->label(kind.label);
    return correction;
  }
  std::string there;
  for (const std::string& n : names()) there += (there.empty() ? "" : ", ") + n;
  throw Error("--correct", text, "there is no such correction; there are " + there);
}

std::vector<Correction> correctionsNamed(const std::vector<std::string>& texts) {
  std::vector<Correction> corrections;
  for (auto text = texts.begin(); text != texts.end(); ++text) {
    if (std::find(texts.begin(), text, *text) != text) throw Error("--correct", *text, "given twice");
    corrections.push_back(Correction::named(*text));
  }
  return corrections;
}

void Correction::apply(Sample& sample, const Vehicle& vehicle, Time time_zero) const {
  if (sample.label != label_) return;
  if (apply_ != nullptr) apply_(*this, sample, vehicle);
  if (reorders() && sample.time != Time{})
    sample.time = after(time_zero, clock_factor_ * secondsBetween(time_zero, sample.time) + clock_offset_s_);
}

}  // namespace fathom
