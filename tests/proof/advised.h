#pragma once

#include <nlohmann/json.hpp>

#include "programs.h"
#include "score.h"

namespace fathom::proof {

/// What the answer to a case advises, not yet driven: where it is one set of several effects, the hidden one
/// among them, which lasts and is alone. Else nothing, as where no manoeuvre would tell the set apart.
std::optional<Advised> adviceIn(const Scored& scored, const nlohmann::json& answer);

/// The same vehicle, with what it hides, on the advised dive: at rest for 4 s where the answer has it then,
/// levelled, then a minute of the manoeuvre. `recording`, `answer`: folders of the first; `path`: the file
/// that the dive's path is written to, to stand beside the case. Throws Error.
nlohmann::json advisedCase(const ProofCase& proof_case, const Advised& advised,
                           const std::filesystem::path& recording, const std::filesystem::path& answer,
                           const std::filesystem::path& path);

}  // namespace fathom::proof
