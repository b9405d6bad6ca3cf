#pragma once

#include <string>

namespace fathom::sealed {

/// FIPS 180-4, as 64 hexadecimal digits.
std::string sha256(const std::string& bytes);

}  // namespace fathom::sealed
