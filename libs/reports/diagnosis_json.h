#pragma once

#include <nlohmann/json_fwd.hpp>

#include "reports/diagnosis_story.h"

namespace fathom {

/// result.json: {"diagnosis": {"verdict", "mismatch", "effects", "alternatives", "heldout", …}, …}. Times are
/// seconds since the recording's first entry.
nlohmann::ordered_json toJson(const DiagnosisStory& story);

}  // namespace fathom
