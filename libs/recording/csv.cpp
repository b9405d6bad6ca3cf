#include "recording/csv.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "core/files.h"

namespace fathom {
namespace {

/// Lines of a file, gzip or plain (zlib tells them apart).
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : name_(file.string()), gz_(gzopen(name_.c_str(), "rb")) {
    if (!gz_ || isFolder(file)) throw Error(name_, "", "cannot be read");
    gzbuffer(gz_.get(), 1U << 17U);
  }

  bool next(std::string& line) {
    constexpr std::size_t kLongestLine = 4096;
    line.clear();
    ++number_;
    int c = gzgetc(gz_.get());
    if (c < 0) {
      rejectDamage();
      return false;
    }
    for (; c >= 0 && c != '\n'; c = gzgetc(gz_.get())) {
      if (line.size() == kLongestLine) throw error("longer than 4096 characters: not a table");
      line.push_back(static_cast<char>(c));
    }
    if (c < 0) rejectDamage();
    if (line.ends_with('\r')) line.pop_back();
    return true;
  }

  Error error(const std::string& why) const { return {name_, "line " + std::to_string(number_), why}; }

 private:
  void rejectDamage() const {
    int problem = Z_OK;
    const char* why = gzerror(gz_.get(), &problem);
    if (problem != Z_OK) throw error(std::string("damaged or cut off: ") + why);
  }
  struct Close {
    void operator()(gzFile_s* gz) const { gzclose(gz); }
  };

  std::string name_;
  std::unique_ptr<gzFile_s, Close> gz_;
  std::size_t number_ = 0;
};

std::vector<std::string_view> splitAtCommas(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const auto comma = line.find(',');
    fields.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

/// Where each wanted column stands in the file.
std::vector<std::size_t> findColumns(const Lines& lines, const std::string& header,
                                     const std::vector<std::string>& columns) {
  const auto names = splitAtCommas(header);
  for (const auto name : names) {
    if (std::find(columns.begin(), columns.end(), name) == columns.end())
      throw lines.error("unknown column `" + std::string(name) + "`");
    if (std::count(names.begin(), names.end(), name) > 1)
      throw lines.error("column `" + std::string(name) + "` twice");
  }
  std::vector<std::size_t> places;
  for (const std::string& column : columns) {
    const auto at = std::find(names.begin(), names.end(), column);
    if (at == names.end()) throw lines.error("column `" + column + "` is missing");
    places.push_back(static_cast<std::size_t>(at - names.begin()));
  }
  return places;
}

std::optional<double> finiteNumber(std::string_view field) {
  double value = 0.0;
  const auto [end, problem] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (problem != std::errc() || end != field.data() + field.size() || !std::isfinite(value)) return {};
  return value;
}

bool isAbsent(std::string_view field) {
  return field.empty() || field == "nan" || field == "NaN" || field == "NAN";
}

double toNumber(const Lines& lines, std::string_view field) {
  if (const auto value = finiteNumber(field)) return *value;
  throw lines.error("not a finite number: `" + std::string(field) + "`");
}

std::string headerOf(Lines& lines, const std::filesystem::path& file) {
  std::string line;
  if (!lines.next(line)) throw Error(file.string(), "line 1", "empty: must start with the columns' names");
  return line;
}

Error wrongFieldCount(const Lines& lines, std::size_t fields, std::size_t columns) {
  return lines.error("has " + std::to_string(fields) + " fields instead of " + std::to_string(columns));
}

/// Hands each row's fields, so many, to `take`. Throws Error: another number of them, or no row.
template <class Take>
void forEachRow(Lines& lines, std::size_t columns, const Take& take) {
  std::string line;
  bool any = false;
  for (; lines.next(line); any = true) {
    const auto fields = splitAtCommas(line);
    if (fields.size() != columns) throw wrongFieldCount(lines, fields.size(), columns);
    take(fields);
  }
  if (!any) throw lines.error("has no rows");
}

}  // namespace

std::vector<std::vector<double>> readCsv(const std::filesystem::path& file,
                                         const std::vector<std::string>& columns, AbsentNumbers absent) {
  Lines lines(file);
  const auto places = findColumns(lines, headerOf(lines, file), columns);
  std::vector<std::vector<double>> rows;
  forEachRow(lines, places.size(), [&](const std::vector<std::string_view>& fields) {
    std::vector<double> row;
    row.reserve(places.size());
    for (const std::size_t place : places)
      row.push_back(absent == AbsentNumbers::nan && !row.empty() && isAbsent(fields[place])
                        ? std::numeric_limits<double>::quiet_NaN()
                        : toNumber(lines, fields[place]));
    if (!rows.empty() && row[0] <= rows.back()[0]) throw lines.error("time does not increase");
    rows.push_back(std::move(row));
  });
  return rows;
}

Error TextTable::error(std::size_t row, const std::string& why) const {
  return {file.string(), "line " + std::to_string(row + 2), why};
}

double TextTable::number(std::size_t row, std::size_t column) const {
  if (const auto value = finiteNumber(rows[row][column])) return *value;
  throw error(row, "not a finite number: `" + rows[row][column] + "`");
}

int TextTable::wholeNumber(std::size_t row, std::size_t column) const {
  constexpr double kLargest = 1e8;
  const double value = number(row, column);
  if (value < 0 || value != std::floor(value) || value > kLargest)
    throw error(row, columns[column] + " must be a whole number from 0 on");
  return static_cast<int>(value);
}

std::string headerLine(const std::vector<std::string>& columns) {
  std::string line;
  for (const std::string& column : columns) line += (line.empty() ? "" : ",") + column;
  return line;
}

TextTable readTable(const std::filesystem::path& file) {
  Lines lines(file);
  const std::string header = headerOf(lines, file);
  const auto names = splitAtCommas(header);
  TextTable table{file, {names.begin(), names.end()}, {}};
  forEachRow(lines, names.size(), [&](const std::vector<std::string_view>& fields) {
    table.rows.emplace_back(fields.begin(), fields.end());
  });
  return table;
}

std::vector<std::vector<std::string>> readLines(const std::filesystem::path& file) {
  Lines lines(file);
  std::vector<std::vector<std::string>> all;
  for (std::string line; lines.next(line);) {
    const auto fields = splitAtCommas(line);
    if (!all.empty() && fields.size() != all.front().size())
      throw wrongFieldCount(lines, fields.size(), all.front().size());
    all.emplace_back(fields.begin(), fields.end());
  }
  if (all.empty()) throw lines.error("the file is empty");
  return all;
}

TextTable readTable(const std::filesystem::path& file, const std::vector<std::string>& columns) {
  TextTable table = readTable(file);
  if (table.columns != columns) throw Error(file.string(), "line 1", "must be " + headerLine(columns));
  return table;
}

}  // namespace fathom
