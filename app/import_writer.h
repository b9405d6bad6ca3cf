#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "audit/corrected_samples.h"
#include "audit/finding.h"
#include "audit/streams.h"
#include "commands.h"
#include "recording/imported.h"
#include "recording/rawlog.h"

namespace fathom {

/// Writes samples of an import as they come. The rawlog is opened at the first, whose time its first entry
/// bears.
class ImportWriter {
 public:
  /// `header`: without the vehicle file, which this writes. `vehicle`: by whose gravity and water entries are
  /// corrected.
  ImportWriter(ImportTarget target, RecordingHeader header, const std::vector<std::string>& correct,
               Vehicle vehicle);

  /// Throws Interrupted.
  void write(Sample sample);
  /// The companions first, the rawlog last: where it is, all is.
  void finish(const ImportedRecording& imported, const RunContext& context);

 private:
  void writeCorrected(const Sample& sample);
  nlohmann::ordered_json summary(const ImportedRecording& imported, const RunContext& context) const;
  void report(const ImportedRecording& imported) const;

  ImportTarget target_;
  RecordingHeader header_;
  CorrectedSamples corrected_;
  Streams streams_;
  std::vector<Finding> findings_;
  std::optional<RawlogWriter> rawlog_;
  std::size_t samples_ = 0;
};

/// --correct, of an import.
void addCorrect(CLI::App& command, std::vector<std::string>& names);

}  // namespace fathom
