#pragma once

#include <string>
#include <vector>

#include "recording/axes.h"
#include "recording/samples.h"
#include "sensors/vehicle.h"

namespace fathom {

/// "x,-y,-z", as SignedAxes::text() without brackets and blanks.
std::string plainText(const SignedAxes& axes);

struct AttitudeReading;
struct PressureUnit;

/// One way to correct entries, as --correct names it: "NAME", of an instrument that is not the first
/// "NAME.2", where it needs more "NAME:x,-y,-z", "dvl-turned:DEGREES", "clock-rate:LABEL:FACTOR" or
/// "clock-offset:LABEL:SECONDS".
class Correction {
 public:
  /// Throws Error, about --correct, where there is no such correction; it lists those there are.
  static Correction named(const std::string& text);
  /// Names, for help.
  static std::vector<std::string> names();

  /// Corrects an entry that it concerns, leaves others alone.
  void apply(Sample& sample, const Vehicle& vehicle, Time time_zero) const;
  /// How fast the corrected clock of some entries runs, at the slowest: 1 but for clock-rate.
  double slowest() const { return clock_factor_ < 1 ? clock_factor_ : 1; }
  /// By how much earlier it makes some entries, at most; s.
  double earlier_s() const { return clock_offset_s_ < 0 ? -clock_offset_s_ : 0; }
  const std::string& label() const { return label_; }
  bool reorders() const { return clock_factor_ != 1 || clock_offset_s_ != 0; }

 private:
  using Apply = void (*)(const Correction&, Sample&, const Vehicle&);
  struct Kind;
  static std::vector<Kind> makeKinds();
  static const std::vector<Kind>& kinds();

  Apply apply_ = nullptr;
  double factor_ = 1;
  const AttitudeReading* reading_ = nullptr;
  const PressureUnit* unit_ = nullptr;
  std::string label_;  ///< of entries that it concerns
  Matrix3d axes_ = Matrix3d::Identity();
  double clock_factor_ = 1;    ///< of stamps, about the first of the recording
  double clock_offset_s_ = 0;  ///< added to stamps
};

/// Throws Error as named(), and where one is given twice.
std::vector<Correction> correctionsNamed(const std::vector<std::string>& texts);

}  // namespace fathom
