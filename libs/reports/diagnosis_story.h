#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/elsewhere.h"
#include "inputs/batch_recording.h"
#include "report/run_info.h"
#include "report/table.h"
#include "reports/image_comparison.h"

namespace fathom {

/// The localization tasks run again, without and with what was found.
struct DiagnosisRerun {
  Table table;  ///< the paper's rows of both
  std::vector<std::string> remarks;
};

/// What was found, judged on another recording.
struct JudgedRecording {
  std::filesystem::path recording;
  Elsewhere result;
};

/// A diagnosis, done, and what it was made from.
struct DiagnosisStory {
  RunInfo run;
  std::filesystem::path recording, folder;
  BatchRecording read;
  double false_alarm = 0.05;
  Diagnosis diagnosis;
  std::vector<JudgedRecording> elsewhere;
  std::optional<DiagnosisRerun> rerun;
  std::vector<ComparedImage> images;
};

// ---- what the terminal, result.json and report.html say alike

/// A parameter of an effect found.
struct FoundParameter {
  std::string name, unit;
  std::vector<double> value;
  std::vector<double> sigma;  ///< as many; empty where it was chosen, not estimated
  std::string word{};         ///< what the value stands for, where that is not a number: a sensor
};
/// All that the effect has, by the names in the registry, derived ones with what the final estimate has.
std::vector<FoundParameter> parametersOf(const FoundEffect& effect, const DiagnosisStory& story);
/// "0.0153 ± 0.0004 m": digits as sigma deserves them; lists in brackets.
std::string textOf(const FoundParameter& parameter);

/// An interval as far as the recording has it, s since its first entry; nothing where it is for good.
std::optional<Interval> within(const Interval& interval, const BatchData& data);
/// When a candidate was on, of one that was on for a part only: of a peak two widths to either side.
std::optional<Interval> activeIn(const Candidate& candidate, const BatchData& data);
/// "12.0 to 171.0 s", "always".
std::string textOf(const std::optional<Interval>& interval);

/// exp(log_p) for a reader, however small: "0.0312", "4.5e-173".
std::string probabilityText(double log_p);

/// Whether a mismatch is more than chance leaves of no mismatch.
bool isSignificant(const Mismatch& mismatch, double false_alarm);
/// "markers, right", "dvl y", "depth".
std::string sensorOf(const Mismatch& mismatch);

/// "97 %", "0.4 %".
std::string shareText(double share);
/// A row for each parameter of each of them.
Table effectTable(const DiagnosisStory& story);
/// Root mean squares on held-out stretches, a row for each channel.
Table heldOutTable(const HeldOutResult& heldout);
/// Of other recordings, a row for each, the channel that changes most.
Table elsewhereTable(const DiagnosisStory& story);
/// Whether light was compared, so that the water is known: as water.yaml beside the report has it.
bool hasWater(const DiagnosisStory& story);
/// The command that simulates the dive with what was found; empty where images alone tell of the path.
std::string simulateCommand(const DiagnosisStory& story);

}  // namespace fathom
