#include "common_options.h"

#include "commands.h"

namespace fathom {
namespace {

CLI::Validator numberThat(bool (*is_right)(double), const std::string& must_be, const std::string& kind) {
  return {[=](const std::string& text) {
            double value = 0;
            return CLI::detail::lexical_cast(text, value) && is_right(value)
                       ? ""
                       : "must be " + must_be + ", not " + text;
          },
          kind};
}

/// The files would lie elsewhere than in --out, or have no name.
std::string whyNoName(const std::string& name) {
  const bool is_name = !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos;
  return is_name ? "" : "`" + name + "` is no file's name";
}

}  // namespace

CLI::Validator positive() {
  return numberThat([](double value) { return value > 0; }, "greater than zero", "POSITIVE");
}
CLI::Validator notNegative() {
  return numberThat([](double value) { return value >= 0; }, "zero or greater", "NONNEGATIVE");
}

void addNameOption(CLI::App& command, std::string& name, const std::string& default_name) {
  command.add_option("--name", name, "NAME of the files (default: " + default_name + ")")
      ->check(CLI::Validator(whyNoName, ""));
}

void addAuditOptions(CLI::App& command, AuditChoice& choice) {
  command
      .add_option("--accept", choice.accept,
                  "A fault of the recording's streams to take as it is, as `fathom info` names it")
      ->type_name("NAME");
  command
      .add_option("--correct", choice.correct,
                  "A fault of the recording's streams to correct, as `fathom info` says it")
      ->type_name("NAME");
}

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
  addAuditOptions(command, options.audit);
}

void addBatchInputOptions(CLI::App& command, BatchRecordingOptions& options) {
  command.add_option("--vehicle", options.vehicle, "Vehicle file (default: the one the recording names)")
      ->type_name(values::kYaml);
  command.add_option("--map", options.map, "Panel map (default: the one the recording names)")
      ->type_name(values::kYaml);
  command.add_option("--start", options.start, "auto, reference or X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]")
      ->capture_default_str();
  addAuditOptions(command, options.audit);
}

void addBatchRecordingOptions(CLI::App& command, BatchRecordingOptions& options) {
  command.add_option("RECORDING", options.rawlog, "The recording")->required()->type_name(values::kRawlog);
  command.add_option("--out", options.folder, "Where the results go")->required()->type_name(values::kFolder);
  addBatchInputOptions(command, options);
}

CLI::Option* addCalibrationOption(CLI::App& command, std::string& file, const std::string& help) {
  return command.add_option("--calibration", file, help)->type_name(values::kYaml);
}

CLI::Option* addTimeOption(CLI::App& command, double& t_s, CLI::Option* calibration) {
  return command
      .add_option("--at", t_s, "When the views are taken, s since the recording's first entry, for effects")
      ->needs(calibration)
      ->capture_default_str();
}

}  // namespace fathom
