#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fathom {

/// Reads a table of numbers, gzip or plain: a header line with exactly these column names, in any order, then
/// rows; returned in the order of `columns`. The first of `columns` is the time and must increase.
/// Throws Error with file and line: cannot be read, damaged gzip, a column missing, unknown or twice, wrong
/// number of fields, not a finite number, time not increasing, no row at all.
std::vector<std::vector<double>> readCsv(const std::filesystem::path& file,
                                         const std::vector<std::string>& columns);

}  // namespace fathom
