#include "core/version.h"

namespace fathom {

const char* programVersion() { return PROGRAM_VERSION; }

}  // namespace fathom
