#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/random.h"
#include "programs.h"
#include "proof_case.h"
#include "resolution.h"

namespace fathom::proof {

/// One of the generator's dives.
struct DivePlan {
  const char *manoeuvre, *water;
  bool images = false;
  double duration_s = 80;
};

/// A dive that cases share, and what its recordings can resolve.
struct PlannedDive {
  nlohmann::json json;  ///< as the generator has it
  bool images = false;
  double duration_s = 0, ordinary = 0;
  std::optional<Resolution> resolution;
};
/// `ordinary`: see Extent.
PlannedDive plannedDive(const DivePlan& plan, std::uint64_t seed, double ordinary = 0);

/// The dive with nothing hidden, noise and all.
nlohmann::json generatorCase(const std::string& name, const PlannedDive& dive, std::uint64_t seed);
/// Seals a recording in `folder` and reads it as the program does.
BatchInput sealedInput(const nlohmann::json& generator_case, const Programs& programs,
                       const std::filesystem::path& folder);

/// The catalogue without what the sealed generator cannot make.
const std::vector<EffectInfo>& effectsOfGenerator();
/// Whether an effect can be hidden on the dive, in any size: the Earth's rotation has just one, light takes
/// images, and something has to depend on it.
bool canHide(const EffectInfo& effect, const PlannedDive& dive);
/// An effect at random, as far as the generator can make it.
Hidden madeEffect(const EffectInfo& effect, const PlannedDive& dive, Random& random);
/// Nothing where it would have to be larger than anybody would hide.
std::optional<Hidden> ofSize(const Hidden& hidden, const PlannedDive& dive, double sqrt_lambda);

/// For the generator.
nlohmann::json generatorEffect(const Hidden& hidden, const PlannedDive& dive);
/// For the scorer. `tempts`: which rivals count as runners-up.
ProofCase::Effect describedEffect(
    const Hidden& hidden, const Resolution& resolution,
    const std::function<bool(const Rival&)>& tempts = [](const Rival&) { return true; });

}  // namespace fathom::proof
