#pragma once

#include <string>

namespace fathom {

/// printf into a string of any length.
__attribute__((format(printf, 1, 2))) std::string print(const char* format, ...);

}  // namespace fathom
