#pragma once

#include <filesystem>
#include <string>

#include "diagnosis/error_budget.h"

namespace fathom {

/// Form: config/error_budget.yaml. Throws Error where the file is none, or names what nobody knows: with the
/// key.
ErrorBudget readErrorBudget(const std::filesystem::path& file);
ErrorBudget parseErrorBudget(const std::string& text, const std::string& name);
/// As it is read. `comment`: the first line.
std::string formatErrorBudget(const ErrorBudget& budget, const std::string& comment);
/// config/error_budget.yaml, which is what counts where nobody says otherwise.
const ErrorBudget& fieldBudget();
/// config/laboratory_budget.yaml: where panel, camera and clocks were measured.
const ErrorBudget& laboratoryBudget();

}  // namespace fathom
