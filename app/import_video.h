#pragma once

#include "commands.h"

namespace fathom {

/// `import video`.
void addImportVideo(CLI::App& parent, const RunContext& context);

}  // namespace fathom
