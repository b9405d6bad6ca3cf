#include "import_target.h"

#include <iostream>

#include "commands.h"

namespace fathom {

void sayWritten(const ImportTarget& target, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings) std::cout << "wrote " << target.file(ending).string() << "\n";
}

void addImportTarget(CLI::App& command, ImportTarget& target, const std::string& default_name) {
  command.add_option("--out", target.folder, "Where the recording goes")
      ->required()
      ->type_name(values::kFolder);
  command.add_option("--name", target.name, "NAME of the files (default: " + default_name + ")");
}

}  // namespace fathom
