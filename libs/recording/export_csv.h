#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "recording/rawlog.h"

namespace fathom {

struct CsvExport {
  std::vector<std::filesystem::path> files;  ///< one a sensor label, sorted
  /// Entries that the convention does not know, which have no table: how many, by label and class.
  std::map<std::string, std::uint64_t> left_out;
  std::optional<RecordingLoss> loss;
};

/// Writes a rawlog's entries as tables, FOLDER/LABEL.csv (characters other than letters, digits, _ and - of
/// the label as %XX). First line: column names with frame and unit. Every row begins with
///     time_unix_s   UTC seconds since 1970, 7 decimals
///     time_s        seconds since the recording's first entry, 7 decimals
/// then the fields in full precision, NaN where a field is absent; images as their file names. Panels and
/// markers that were seen have a row each.
/// `progress`, where given, is called now and then with the share done.
/// Throws Error where the rawlog cannot be read, the number of DVL beams changes, or the disk is full.
CsvExport exportCsv(const std::filesystem::path& rawlog, const std::filesystem::path& folder,
                    const std::function<void(double)>& progress = {});

}  // namespace fathom
