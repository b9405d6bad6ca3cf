#pragma once

#include "commands.h"

namespace fathom {

/// `import corners`.
void addImportCorners(CLI::App& parent, const RunContext& context);

}  // namespace fathom
