#pragma once

#include <string>
#include <vector>

#include "audit/finding.h"
#include "recording/samples.h"
#include "sensors/vehicle.h"

/// Recordings with one fault of their streams, as drivers make them, for the audit.
namespace fathom::test {

/// A kind of fault: what it does to samples, and what an audit should call it.
struct StreamFault {
  std::string name;   ///< of the finding
  std::string label;  ///< whose entries it changes

  /// Whether a finding is of it: by name, or as one of several that the recording cannot tell apart.
  bool isNamedBy(const Finding& finding) const;
};

/// All kinds that a vehicle's recording can have; the first is none.
std::vector<StreamFault> streamFaults(const Vehicle& vehicle);

/// A vehicle with an INS (with an attitude or without), a DVL and a pressure sensor at random mountings and
/// of random quality.
Vehicle randomVehicle(std::uint64_t seed);

/// Two minutes of it, with wide or small, fast or slow motion in all axes; the robot stays about upright.
std::vector<Sample> randomDive(const Vehicle& vehicle, std::uint64_t seed);

/// The same with the fault.
void addFault(const StreamFault& fault, const Vehicle& vehicle, std::uint64_t seed,
              std::vector<Sample>& samples);

}  // namespace fathom::test
