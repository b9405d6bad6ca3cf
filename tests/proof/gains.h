#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "estimation/batch_estimate.h"
#include "score.h"

namespace fathom::proof {

/// What calibrations are worth on a dive that nothing was fitted to. Nothing where the hidden effect does not
/// last, where it is drawn for each image, or where the nominal model cannot be fitted. `recording`: where
/// the runner-up is fitted; `judge`: the other dive; `stated`: what the program wrote as calibration.yaml;
/// `answer`: its result.json, for the black box.
std::optional<Gains> gainsOf(const ProofCase& proof_case, const BatchInput& recording,
                             const BatchInput& judge, const EffectParameters<double>& stated,
                             const nlohmann::json& answer);

}  // namespace fathom::proof
