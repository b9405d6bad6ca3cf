#include "report/table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/text.h"

namespace fathom {
namespace {

const std::string& cell(const std::vector<std::string>& row, std::size_t column) {
  static const std::string empty;
  return column < row.size() ? row[column] : empty;
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// 12, -0.5, +3 m/s, ±2, inf; not "2D" or "17-DVL".
bool looksLikeNumber(std::string text) {
  for (const char* sign : {"±", "+", "-", "−", "<", "> "})
    if (text.starts_with(sign)) text.erase(0, std::string(sign).size());
  if (text == "inf") return true;
  if (text.empty() || !isDigit(text[0])) return false;
  const std::size_t end = text.find_first_not_of("0123456789.,eE+-:");
  return end == std::string::npos || text[end] == ' ' || text[end] == '%';
}

bool isAbsent(const std::string& text) { return text.empty() || text == "-"; }

/// Characters, not bytes: UTF-8 continuation bytes do not count.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t columns, bool flush_right) {
  const std::string space(columns - width(text), ' ');
  return flush_right ? space + text : text + space;
}

}  // namespace

std::string plusMinus(double value, double sigma) {
  if (!(sigma > 0) || !std::isfinite(sigma)) return print("%.6g", value);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 9);
  return fixed(value, decimals) + " ± " + fixed(sigma, decimals);
}

bool isNumeric(const Table& table, std::size_t column) {
  bool any = false;
  for (const auto& row : table.rows) {
    const std::string& text = cell(row, column);
    if (isAbsent(text)) continue;
    if (!looksLikeNumber(text)) return false;
    any = true;
  }
  return any;
}

std::string formatTable(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    widths.push_back(width(table.header[column]));
    for (const auto& row : table.rows) widths[column] = std::max(widths[column], width(cell(row, column)));
  }
  const auto line = [&](const std::vector<std::string>& row) {
    std::string text;
    for (std::size_t column = 0; column < widths.size(); ++column)
      text += (column == 0 ? "" : "  ") + padded(cell(row, column), widths[column], isNumeric(table, column));
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  };
  std::string text = line(table.header);
  for (const auto& row : table.rows) text += line(row);
  return text;
}

std::string fixed(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  std::array<char, 400> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, value);
  const std::string text = buffer.data();
  return text.starts_with("-") && text.find_first_of("123456789") == std::string::npos ? text.substr(1)
                                                                                       : text;
}

}  // namespace fathom
