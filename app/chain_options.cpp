#include "chain_options.h"

#include "commands.h"

namespace fathom {

void addChainOptions(CLI::App& command, ChainOptions& options) {
  command.add_option("--vehicle", options.vehicle, "Vehicle file (default: the one the recording names)")
      ->type_name(values::kYaml);
  command.add_option("--map", options.map, "Panel map (default: the one the recording names)")
      ->type_name(values::kYaml);
  command.add_flag("--panel-unknown", options.panel_unknown,
                   "Estimate the panels' poses too: the map's are not believed");
  command.add_option("--calibration", options.calibration, "Effects known to be there")
      ->type_name(values::kYaml);
  command
      .add_option("--sources", options.sources, "Which sensors come from a simulation or another recording")
      ->type_name(values::kYaml);
  command.add_option("--backend", options.backend, "Which library finds the markers")
      ->check(CLI::IsMember(backendNames()))
      ->capture_default_str();
}

}  // namespace fathom
