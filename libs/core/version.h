#pragma once

namespace fathom {

/// "0.2.0": semantic, as in every result.json. What was kept by another version is made anew.
const char* programVersion();

}  // namespace fathom
