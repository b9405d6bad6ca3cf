#include "proof_case.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace fathom::proof {

nlohmann::ordered_json toJson(const ProofCase& c) {
  nlohmann::ordered_json effects = nlohmann::ordered_json::array();
  for (const ProofCase::Effect& e : c.effects)
    effects.push_back({{"id", e.id},
                       {"name", e.name},
                       {"sqrt_lambda", e.sqrt_lambda},
                       {"inseparable", e.inseparable},
                       {"nearest", e.nearest},
                       {"runner_up", e.runner_up}});
  return {{"name", c.name},     {"kind", nameOf(c.kind)}, {"stratum", c.stratum},    {"effects", effects},
          {"lambda", c.lambda}, {"left", c.left},         {"generator", c.generator}};
}

ProofCase caseOf(const nlohmann::json& json) {
  ProofCase c;
  c.name = json.at("name");
  const auto kind = std::find(kKinds.begin(), kKinds.end(), json.at("kind").get<std::string>());
  c.kind = static_cast<ProofCase::Kind>(kind - kKinds.begin());
  c.stratum = json.at("stratum");
  for (const nlohmann::json& e : json.at("effects"))
    c.effects.push_back({e.at("id"), e.at("name"), e.at("sqrt_lambda"), e.at("inseparable"), e.at("nearest"),
                         e.at("runner_up")});
  c.lambda = json.at("lambda");
  c.left = json.at("left");
  c.generator = json.at("generator");
  return c;
}

}  // namespace fathom::proof
