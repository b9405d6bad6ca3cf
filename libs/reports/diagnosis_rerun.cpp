#include "reports/diagnosis_rerun.h"

#include <algorithm>

#include "core/shipped_file.h"
#include "reports/tasks_report.h"

namespace fathom {
namespace {

/// The paper's columns of one job, errors and m_A, told apart by what is written before them.
void addRows(const LocalizedRecording& done, const std::string& calibration, DiagnosisRerun& rerun) {
  const Table table = taskTable(done);
  const auto columns = std::find(table.header.begin(), table.header.end(), "m_A") + 1 - table.header.begin();
  const auto withName = [&](const std::vector<std::string>& row, const std::string& name) {
    std::vector<std::string> result{name};
    result.insert(result.end(), row.begin(), row.begin() + columns);
    return result;
  };
  rerun.table.header = withName(table.header, "calibration");
  for (const auto& row : table.rows) rerun.table.rows.push_back(withName(row, calibration));
}

}  // namespace

RecordingJob rerunJob(const BatchRecordingOptions& recording, const std::string& command_line) {
  RecordingJob job;
  job.chain.rawlog = recording.rawlog;
  job.chain.vehicle = recording.vehicle;
  job.chain.map = recording.map;
  job.chain.audit = recording.audit;
  job.start = recording.start;
  job.tasks = {{readLocalizationOptions(shippedFile("config/improved.yaml"), readTask("TL5")), true}};
  job.command_line = command_line;
  return job;
}

DiagnosisRerun rerunTasks(RecordingJob job, const std::string& known_calibration,
                          const std::filesystem::path& folder) {
  DiagnosisRerun rerun;
  job.chain.calibration = known_calibration;
  job.folder = folder / "localized_before";
  const LocalizedRecording before = localizeRecording(job);
  addRows(before, known_calibration.empty() ? "nominal" : "as known before", rerun);
  job.chain.calibration = (folder / "calibration.yaml").string();
  job.folder = folder / "localized_after";
  addRows(localizeRecording(job), "as found", rerun);
  rerun.remarks = before.story->remarks;
  return rerun;
}

}  // namespace fathom
