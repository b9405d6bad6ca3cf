#pragma once

#include <string>

namespace fathom {

/// printf into a string of any length.
__attribute__((format(printf, 1, 2))) std::string print(const char* format, ...);

/// The shortest text that reads back to the same number; no "-0".
std::string shortest(double value);

}  // namespace fathom
