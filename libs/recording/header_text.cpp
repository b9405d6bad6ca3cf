#include "recording/header_text.h"

#include <sstream>

namespace fathom {
namespace {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\\\";
    else if (c == '\n')
      result += "\\n";
    else if (c == '\r')
      result += "\\r";
    else
      result += c;
  }
  return result;
}

std::string unescaped(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char next = i + 1 < text.size() ? text[i + 1] : '\0';
    const bool escape = text[i] == '\\' && (next == '\\' || next == 'n' || next == 'r');
    if (!escape) {
      result += text[i];
      continue;
    }
    result += next == 'n' ? '\n' : next == 'r' ? '\r' : '\\';
    ++i;
  }
  return result;
}

std::string trimmed(const std::string& text) {
  constexpr const char* kBlanks = " \t\r";
  const auto begin = text.find_first_not_of(kBlanks);
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

}  // namespace

std::string headerText(const RecordingHeader& header) {
  return "[recording]\npanel_map = " + escaped(header.panel_map) + "\nvehicle = " + escaped(header.vehicle) +
         "\ndescription = " + escaped(header.description) + "\n";
}

// Not by way of MRPT's configuration reader: that one expands environment variables.
RecordingHeader parseHeaderText(const std::string& text) {
  RecordingHeader header;
  std::istringstream lines(text);
  std::string line;
  bool in_section = false;
  while (std::getline(lines, line)) {
    line = trimmed(line);
    if (!line.empty() && line.front() == '[') in_section = line == "[recording]";
    const auto equals = line.find('=');
    if (!in_section || equals == std::string::npos) continue;
    const std::string key = trimmed(line.substr(0, equals));
    const std::string value = unescaped(trimmed(line.substr(equals + 1)));
    if (key == "panel_map") header.panel_map = value;
    if (key == "vehicle") header.vehicle = value;
    if (key == "description") header.description = value;
  }
  return header;
}

}  // namespace fathom
