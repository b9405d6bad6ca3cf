#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "audit/correction.h"
#include "audit/finding.h"
#include "audit/streams.h"
#include "recording/sample_source.h"

/// What is wrong with a recording's streams: each compared with physics and with the others. The one place
/// that says so, for importers, `fathom info`, and whoever is about to believe a recording.
namespace fathom {

/// What was found, the INS's first: where it is wrong it is no witness against others. With no vehicle file,
/// the defaults' data sheets are compared with. `image_folder`: some images are looked at; empty: none.
std::vector<Finding> audit(const Streams& streams, const Vehicle& vehicle,
                           const std::filesystem::path& image_folder = {});
/// Reads a source to its end.
std::vector<Finding> audit(SampleSource& source, const Vehicle& vehicle);

/// What a user says of findings.
struct AuditChoice {
  std::vector<std::string> accept;   ///< names of findings that are no error
  std::vector<std::string> correct;  ///< corrections, see Correction::named()
};

/// As CorrectedSource, where there is something to correct. Throws Error where there is no such correction.
std::unique_ptr<SampleSource> corrected(std::unique_ptr<SampleSource> source, const AuditChoice& choice,
                                        const Vehicle& vehicle);

/// What remains to be said of a recording that is believed.
struct Plausibility {
  std::vector<std::string> remarks;   ///< a line each
  std::vector<std::string> accepted;  ///< names of the findings that were sure, and accepted
};
/// Throws Error, with the first, where a finding is sure and not accepted, and where a name of `accept` is
/// none of a finding.
Plausibility requirePlausible(const std::vector<Finding>& findings, const AuditChoice& choice,
                              const std::filesystem::path& recording);

}  // namespace fathom
