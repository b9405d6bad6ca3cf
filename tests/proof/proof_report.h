#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "report/html_report.h"
#include "score.h"

namespace fathom::proof {

struct ProofResults {
  std::vector<Scored> scored;
  std::vector<nlohmann::json> real;  ///< as answerTo() has them
};

/// Effects by size: how each was answered.
Table effectTable(const std::vector<Scored>& all);
/// Effects that were on for a part of the recording: how each was answered, and when it was said to be on.
Table intervalTable(const std::vector<Scored>& all);
/// What tempted, and how it was answered.
Table decoyTable(const std::vector<Scored>& all);
/// Sets, what was advised, and what came of it.
Table advisedTable(const std::vector<Scored>& all);
/// Effects alone: how many were named first, and what the others were taken for. The confusion matrix, of
/// which only what is not zero is printed.
Table namesTable(const std::vector<Scored>& all);
/// Each recording that was not answered rightly.
Table confusionTable(const std::vector<Scored>& all);

/// All that have rows.
std::vector<Table> tablesOf(const ProofResults& results);

void writeProofReport(const ProofResults& results, const RunInfo& run, const std::filesystem::path& file);

}  // namespace fathom::proof
