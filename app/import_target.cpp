#include "import_target.h"

#include "commands.h"

namespace fathom {

void addImportTarget(CLI::App& command, ImportTarget& target, const std::string& default_name) {
  command.add_option("--out", target.folder, "Where the recording goes")
      ->required()
      ->type_name(values::kFolder);
  command.add_option("--name", target.name, "NAME of the files (default: " + default_name + ")");
}

}  // namespace fathom
