#pragma once

#include <CLI/CLI.hpp>
#include <string>

/// Shell completion scripts, made by walking the command line's own description: a new command or option is
/// completed without a line here.
namespace fathom {

std::string bashCompletion(const CLI::App& root);
std::string zshCompletion(const CLI::App& root);
std::string fishCompletion(const CLI::App& root);

}  // namespace fathom
