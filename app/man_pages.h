#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

/// Manual pages in man(7)'s form, made by walking the command line's own description, as shell completion is.
namespace fathom {

struct ManPage {
  std::string name;  ///< "fathom-import-csv", of section 1
  std::string text;
};

/// Of the program and of every command.
std::vector<ManPage> manPages(const CLI::App& root);

}  // namespace fathom
