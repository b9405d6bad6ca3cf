#include "core/text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdarg>
#include <cstdio>
#include <string_view>

namespace fathom {

std::string print(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  va_list again;
  va_copy(again, arguments);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, arguments)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(arguments);
  return text;
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value + 0.0).ptr;
  return {text.data(), end};
}

std::string oneLine(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return text;
}

std::string printable(const std::string& text) {
  std::string shown;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // U+0080 to U+009F are control characters too: 0xC2 and a byte that is no text by itself.
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    const bool is_c1 = byte == 0xC2 && next >= 0x80 && next < 0xA0;
    if (byte == '\n')
      shown += "\\n";
    else if (is_c1)
      shown += print("\\x%02x", static_cast<unsigned char>(text[++i]));
    else if (std::iscntrl(byte) != 0)
      shown += print("\\x%02x", byte);
    else
      shown += text[i];
  }
  return shown;
}

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string shellWord(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c >= 0x80 ||
           std::string_view("-_./:=,+@%").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::optional<std::array<unsigned, 2>> numbersAround(const std::string& text, char between,
                                                     std::size_t most_digits) {
  const auto middle = text.find(between);
  if (middle == std::string::npos) return std::nullopt;
  const std::array<std::string, 2> parts{text.substr(0, middle), text.substr(middle + 1)};
  for (const std::string& part : parts)
    if (part.empty() || part.size() > most_digits ||
        part.find_first_not_of("0123456789") != std::string::npos)
      return std::nullopt;
  return {{static_cast<unsigned>(std::stoul(parts[0])), static_cast<unsigned>(std::stoul(parts[1]))}};
}

}  // namespace fathom
