#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "programs.h"
#include "report/table.h"

/// Recordings of the real world, of which nobody knows for sure what they hide: no answer is right or wrong.
namespace fathom::proof {

struct RealRecording {
  std::string name, what;             ///< "tank", and a line about it
  std::vector<std::string> import;    ///< arguments of `fathom import`
  std::vector<std::string> diagnose;  ///< options of `fathom diagnose`
};

/// Those whose data is in `data`, none where it is not there. `quick`: only those that take seconds.
std::vector<RealRecording> realRecordings(const std::filesystem::path& data, bool quick);

/// Imports the recording into `folder` and diagnoses it; what the program says: verdict, effects,
/// remainder, held out; or the failure.
nlohmann::ordered_json answerTo(const RealRecording& recording, const Programs& programs,
                                const std::filesystem::path& folder);

/// One row an answer.
Table realTable(const std::vector<nlohmann::json>& answers);

}  // namespace fathom::proof
