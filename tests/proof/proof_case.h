#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/hidden_effect.h"

namespace fathom::proof {

using test::kSeparable;

/// One recording of the proof: what is asked of the generator, and what the scorer knows besides.
struct ProofCase {
  enum class Kind {
    effect,
    pair,
    null,
    outside,
    interval,  ///< an effect that is on for a part of the recording
    decoy      ///< an effect where another one is tempting
  };

  struct Effect {
    std::string id, name;    ///< "marker-moved", "marker-moved 14"
    double sqrt_lambda = 0;  ///< in units of what the dive can resolve
    std::vector<std::string>
        inseparable;        ///< effects (ids) that it cannot be told from: lambda (1 - |c|) < 5.4
    double nearest = 0;     ///< least lambda (1 - |c|) of all others; of a decoy, of what tempts
    std::string runner_up;  ///< whose that is
  };

  std::string name;
  Kind kind = Kind::null;
  double stratum = 0;  ///< sqrt(lambda) that was asked for
  std::vector<Effect> effects;
  double lambda = 0, left = 0;  ///< of what is outside the catalogue: all of it, and what no effect imitates
  nlohmann::json generator;     ///< the generator's case
};

inline constexpr std::array kKinds{"effect", "pair", "null", "outside", "interval", "decoy"};
inline const char* nameOf(ProofCase::Kind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

nlohmann::ordered_json toJson(const ProofCase& proof_case);
/// Throws nlohmann::json::exception.
ProofCase caseOf(const nlohmann::json& json);

}  // namespace fathom::proof
