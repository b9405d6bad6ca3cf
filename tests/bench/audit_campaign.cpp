// The audit on simulated recordings of random vehicles, each without a fault and with one fault of each kind:
// how often it is found under its name, and what else is said.
#include <CLI/CLI.hpp>
#include <iostream>
#include <map>

#include "audit/audit.h"
#include "core/text.h"
#include "support/faulty_streams.h"

namespace fathom {
namespace {

struct Tally {
  int recordings = 0, named = 0, other_name = 0, more = 0;
};

std::vector<Finding> auditOf(const std::vector<Sample>& samples, const Vehicle& vehicle) {
  Streams streams;
  for (const Sample& sample : samples) streams.add(sample);
  return audit(streams, vehicle);
}

void count(const test::StreamFault& fault, std::uint64_t seed, const std::vector<Finding>& findings,
           Tally& tally) {
  ++tally.recordings;
  const std::string& name = fault.name;
  const bool named = name.empty() ? findings.empty() : !findings.empty() && fault.isNamedBy(findings[0]);
  if (named) ++tally.named;
  if (!named && !findings.empty()) ++tally.other_name;
  if (named && findings.size() > 1) ++tally.more;
  if (named && findings.size() < 2) return;
  std::cout << "seed " << seed << ", " << (name.empty() ? "no fault" : name) << ":";
  for (const Finding& f : findings) std::cout << "\n    " << toText(f);
  std::cout << (findings.empty() ? " nothing found\n" : "\n");
}

int run(int argc, char** argv) {
  CLI::App app("The audit on simulated recordings with one fault each");
  int recordings = 500;
  std::uint64_t first_seed = 1001;
  app.add_option("--recordings", recordings, "How many vehicles")->capture_default_str();
  app.add_option("--first-seed", first_seed, "Of the first one")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::map<std::string, Tally> tallies;
  for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(recordings); ++seed) {
    const Vehicle vehicle = test::randomVehicle(seed);
    const std::vector<Sample> clean = test::randomDive(vehicle, seed);
    for (const test::StreamFault& fault : test::streamFaults(vehicle)) {
      std::vector<Sample> samples = clean;
      test::addFault(fault, vehicle, seed, samples);
      const std::vector<Finding> findings = auditOf(samples, vehicle);
      count(fault, seed, findings, tallies[fault.name]);
    }
  }
  std::cout << print("%-32s %10s %10s %12s %10s\n", "fault", "recordings", "named", "other name", "more");
  for (const auto& [name, t] : tallies)
    std::cout << print("%-32s %10d %9.1f%% %12d %10d\n", name.empty() ? "(none)" : name.c_str(), t.recordings,
                       100.0 * t.named / t.recordings, t.other_name, t.more);
  return 0;
}

}  // namespace
}  // namespace fathom

int main(int argc, char** argv) { return fathom::run(argc, argv); }
