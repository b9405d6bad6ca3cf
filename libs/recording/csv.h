#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"

namespace fathom {

/// Reads a table of numbers, gzip or plain: a header line with exactly these column names, in any order, then
/// rows; returned in the order of `columns`. The first of `columns` is the time and must increase.
/// Throws Error with file and line: cannot be read, damaged gzip, a column missing, unknown or twice, wrong
/// number of fields, not a finite number, time not increasing, no row at all. Where absence is allowed, an
/// empty field or `nan` behind the time is NaN.
enum class AbsentNumbers { refused, nan };
std::vector<std::vector<double>> readCsv(const std::filesystem::path& file,
                                         const std::vector<std::string>& columns,
                                         AbsentNumbers absent = AbsentNumbers::refused);

/// A table of text, gzip or plain, as it stands.
struct TextTable {
  std::filesystem::path file;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< row k is line k + 2

  /// An Error at a row.
  Error error(std::size_t row, const std::string& why) const;
  /// Throws Error where it is not a finite number.
  double number(std::size_t row, std::size_t column) const;
  /// Throws Error where it is not a whole number from 0 to 100 million.
  int wholeNumber(std::size_t row, std::size_t column) const;
};
/// A table's first line.
std::string headerLine(const std::vector<std::string>& columns);
/// Throws Error with file and line: cannot be read, damaged gzip, wrong number of fields, no row at all.
TextTable readTable(const std::filesystem::path& file);
/// The same. Throws Error where the columns are not these, in this order.
TextTable readTable(const std::filesystem::path& file, const std::vector<std::string>& columns);

/// The lines of a table, gzip or plain, that need not begin with its columns' names; line k + 1 is at k.
/// Throws Error with file and line: cannot be read, damaged gzip, empty, another number of fields than the
/// first line.
std::vector<std::vector<std::string>> readLines(const std::filesystem::path& file);

}  // namespace fathom
