#pragma once

#include <CLI/CLI.hpp>

/// What no command takes, whichever option it is given to.
namespace fathom {

/// Before the parse, of a whole command line: NaN and infinite numbers are refused, also those that a double
/// has as infinite.
void refuseNonFinite(CLI::App& app);

/// After it: throws Error where --out is a file that another option or argument names. Files are written
/// whole and take the place of what was there; no command writes in place.
void refuseOutputOverInput(const CLI::App& app);

}  // namespace fathom
