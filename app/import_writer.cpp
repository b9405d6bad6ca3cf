#include "import_writer.h"

#include <iostream>

#include "audit/audit.h"
#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "import_target.h"
#include "report/run_info.h"

namespace fathom {

ImportWriter::ImportWriter(ImportTarget target, RecordingHeader header,
                           const std::vector<std::string>& correct, Vehicle vehicle)
    : target_(std::move(target)),
      header_(std::move(header)),
      corrected_(correctionsNamed(correct), std::move(vehicle),
                 [this](const Sample& sample) { writeCorrected(sample); }) {
  header_.vehicle = target_.file("_vehicle.yaml").filename().string();
}

void ImportWriter::write(Sample sample) {
  if (interrupted()) throw Interrupted{};
  corrected_.push(std::move(sample));
}

void ImportWriter::finish(const ImportedRecording& imported, const RunContext& context) {
  corrected_.flush();
  if (!rawlog_) throw Error(target_.file(".rawlog").string(), "", "the source holds no sample");
  writeTextFile(target_.file("_vehicle.yaml"), imported.vehicle_yaml);
  if (!imported.reference.empty()) writeTum(target_.file("_reference.tum"), imported.reference);
  findings_ = audit(streams_, readVehicle(target_.file("_vehicle.yaml")), target_.file("_Images"));
  writeJson(target_.file("_import.json"), summary(imported, context));
  rawlog_->finish();
  report(imported);
}

void ImportWriter::writeCorrected(const Sample& sample) {
  streams_.add(sample);
  if (!rawlog_) rawlog_.emplace(target_.file(".rawlog"), header_, sample.time);
  rawlog_->write(sample);
  ++samples_;
}

nlohmann::ordered_json ImportWriter::summary(const ImportedRecording& imported,
                                             const RunContext& context) const {
  nlohmann::ordered_json json;
  json["run"] = toJson(RunInfo{.command_line = context.command_line});
  json["description"] = header_.description;
  json["samples"] = samples_;
  json["reference_poses"] = imported.reference.size();
  json["remarks"] = imported.remarks;
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& f : findings_) json["findings"].push_back(toText(f));
  json["conclusions"] = nlohmann::ordered_json::array();
  for (const auto& conclusion : imported.conclusions)
    json["conclusions"].push_back({{"what", conclusion.what},
                                   {"concluded", conclusion.concluded},
                                   {"runner_up", conclusion.runner_up},
                                   {"residual_ratio", conclusion.residual_ratio},
                                   {"evidence", conclusion.evidence}});
  return json;
}

void ImportWriter::report(const ImportedRecording& imported) const {
  for (const auto& conclusion : imported.conclusions) std::cout << toText(conclusion) << "\n";
  for (const std::string& remark : imported.remarks) std::cout << "remark: " << remark << "\n";
  for (const Finding& f : findings_) std::cout << "remark: " << toText(f) << "\n";
  std::cout << samples_ << " samples\n";
  sayWritten(target_, {".rawlog", "_vehicle.yaml"});
  if (!imported.reference.empty()) sayWritten(target_, {"_reference.tum"});
  sayWritten(target_, {"_import.json"});
}

void addCorrect(CLI::App& command, std::vector<std::string>& names) {
  command
      .add_option("--correct", names, "A fault of the streams to correct, as the remarks of an import say it")
      ->type_name("NAME");
}

}  // namespace fathom
