#pragma once

#include <span>
#include <string_view>

#include "effects/parameter.h"

namespace fathom {

/// Labels that files and reports have for a parameter's whole numbers, from 0 on: of kinds of sensors, of
/// regions of the image. None of a parameter that is a number there too.
std::span<const std::string_view> wordsOf(ParameterKind kind);

}  // namespace fathom
