#pragma once

#include <vector>

#include "report/html_report.h"
#include "score.h"

namespace fathom::proof {

/// One row a measure: what was asked, what was reached, of how many.
Table measureTable(const std::vector<Scored>& all);
/// Effects by size: how each was answered.
Table effectTable(const std::vector<Scored>& all);
/// What was taken for what, where it was not right.
Table confusionTable(const std::vector<Scored>& all);

void writeProofReport(const std::vector<Scored>& all, const RunInfo& run, const std::filesystem::path& file);

}  // namespace fathom::proof
