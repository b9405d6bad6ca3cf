#include "diagnosis_rerun.h"

#include "tasks_report.h"

namespace fathom {
namespace {

/// The paper's rows of one job, told apart by what is written before them.
void addRows(const LocalizedRecording& done, const std::string& calibration, DiagnosisRerun& rerun) {
  const Table table = taskTable(done);
  rerun.table.header = table.header;
  rerun.table.header.insert(rerun.table.header.begin(), "calibration");
  for (std::vector<std::string> row : table.rows) {
    row.insert(row.begin(), calibration);
    rerun.table.rows.push_back(std::move(row));
  }
}

}  // namespace

RecordingJob rerunJob(const BatchRecordingOptions& recording, const std::string& command_line) {
  RecordingJob job;
  job.chain.rawlog = recording.rawlog;
  job.chain.vehicle = recording.vehicle;
  job.chain.map = recording.map;
  job.start = recording.start;
  job.tasks = {{readLocalizationOptions("config/improved.yaml", readTask("TL5")), true}};
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
