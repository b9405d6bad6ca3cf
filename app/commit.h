#pragma once

namespace fathom {

/// What the program was built from, as `git describe` has it; "unknown" where that was no git checkout. Only
/// the program itself has it: no library changes with it.
const char* commit();

}  // namespace fathom
