#pragma once

#include <CLI/CLI.hpp>

#include "tasks/sample_chain.h"

namespace fathom {

/// All of a chain's options but the rawlog, as options of a command.
void addChainOptions(CLI::App& command, ChainOptions& options);

}  // namespace fathom
