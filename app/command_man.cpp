#include <iostream>
#include <memory>

#include "commands.h"
#include "core/files.h"
#include "man_pages.h"

namespace fathom {

void addMan(const RunContext& context) {
  auto* command =
      context.root->add_subcommand("man", "Write the manual pages, of the program and each command");
  command->footer(
      "Writes FOLDER/man1/fathom.1, fathom-localize.1 and so on: all that --help says.\n"
      "\n"
      "Examples:\n"
      "  fathom man --out out/man\n"
      "  man -M out/man fathom-diagnose");
  const auto folder = std::make_shared<std::string>();
  command->add_option("--out", *folder, "Where they go; a folder of man's search path")
      ->required()
      ->type_name(values::kFolder);
  command->callback([folder, root = context.root] {
    const std::vector<ManPage> pages = manPages(*root);
    for (const ManPage& page : pages)
      writeTextFile(std::filesystem::path(*folder) / "man1" / (page.name + ".1"), page.text);
    std::cout << pages.size() << " pages in " << *folder << "\n";
  });
}

}  // namespace fathom
