#pragma once

#include <string>
#include <vector>

namespace fathom {

/// Rows may be shorter than the header: missing cells are empty.
struct Table {
  std::vector<std::string> header{};
  std::vector<std::vector<std::string>> rows{};
  /// How strongly an HTML page colours each cell, 0 to 1: for a heat map. Missing ones are not.
  std::vector<std::vector<double>> shades{};
};

/// "0.0153 ± 0.0004": so many digits that sigma has two that count; without a sigma as the value is.
std::string plusMinus(double value, double sigma);

/// Whether column i holds numbers (with or without unit; "-" and empty cells count as numbers that are
/// absent), so that it is set flush right.
bool isNumeric(const Table& table, std::size_t column);

/// Aligned plain text for the terminal, lines end in \n. Columns are as wide as their widest cell, counted in
/// UTF-8 characters.
std::string formatTable(const Table& table);

/// A number for a reader: `decimals` digits behind the point; "-" for NaN, "inf" for infinity; no "-0".
std::string fixed(double value, int decimals);

}  // namespace fathom
