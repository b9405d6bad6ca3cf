#include "import_target.h"

#include <iostream>

#include "commands.h"
#include "core/text.h"
#include "recording/imported.h"

namespace fathom {

void sayWritten(const ImportTarget& target, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings) std::cout << "wrote " << target.file(ending).string() << "\n";
}

Time timelessBegin() { return fromUnixSeconds(946684800); }

std::string cameraAloneYaml(const std::string& what, const CameraModel& camera, double rate_hz,
                            double corner_sigma_px) {
  return "# " + what + "\ngravity_m_s2: 9.80665\ncamera:\n" + print("  rate_hz: %.9g\n", rate_hz) +
         cameraLines(camera, corner_sigma_px) + "  pose: " + yamlPose(Pose{}) + "\n";
}

void addImportTarget(CLI::App& command, ImportTarget& target, const std::string& default_name) {
  command.add_option("--out", target.folder, "Where the recording goes")
      ->required()
      ->type_name(values::kFolder);
  command.add_option("--name", target.name, "NAME of the files (default: " + default_name + ")");
}

}  // namespace fathom
