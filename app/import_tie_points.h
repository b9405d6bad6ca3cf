#pragma once

#include "commands.h"

namespace fathom {

/// `import tie-points`.
void addImportTiePoints(CLI::App& parent, const RunContext& context);

}  // namespace fathom
