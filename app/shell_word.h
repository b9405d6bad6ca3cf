#pragma once

#include <string>

namespace fathom {

/// A word of a command line, quoted where a shell needs it.
std::string shellWord(const std::string& word);

}  // namespace fathom
