#include "sources/stress.h"

#include <algorithm>
#include <set>
#include <stdexcept>

namespace fathom {
namespace {

constexpr const char* kFactor = "factor";

void checkVaried(const YamlMap& map, const StressFault& fault) {
  if (fault.vary == kFactor) return;
  const auto keys = fault.stage.strengthKeys();
  if (std::find(keys.begin(), keys.end(), fault.vary) != keys.end()) return;
  std::string known = kFactor;
  for (const std::string& key : keys) known += ", " + key;
  throw map.error("vary", "`" + fault.vary + "` is none of " + known);
}

void checkStrengths(const YamlMap& map, const StressFault& fault) {
  if (fault.strengths.empty()) throw map.error("strengths", "must not be empty");
  for (const double strength : fault.strengths) {
    if (fault.vary == kFactor && strength < 0) throw map.error("strengths", "must not be negative");
    try {
      fault.at(strength);
    } catch (const std::invalid_argument& why) {
      throw map.error("strengths", why.what());
    }
  }
}

StressFault readFault(const YamlMap& map) {
  StressFault fault;
  fault.name = map.text("name");
  fault.vary = map.text("vary");
  fault.strengths = map.numbers("strengths");
  fault.stage = parseDegradationStage(map, fault.vary);
  checkVaried(map, fault);
  checkStrengths(map, fault);
  return fault;
}

}  // namespace

DegradationStage StressFault::at(double strength) const {
  return vary == kFactor ? stage.scaled(strength) : stage.with(vary, strength);
}

std::vector<StressFault> readStress(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  std::vector<StressFault> faults;
  std::set<std::string> names;
  for (const YamlMap& map : yaml.root().maps("faults")) {
    faults.push_back(readFault(map));
    if (!names.insert(faults.back().name).second) throw map.error("name", "is another fault's too");
  }
  yaml.rejectUnknownKeys();
  return faults;
}

}  // namespace fathom
