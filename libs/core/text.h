#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

namespace fathom {

/// printf into a string of any length.
__attribute__((format(printf, 1, 2))) std::string print(const char* format, ...);

/// The shortest text that reads back to the same number; no "-0".
std::string shortest(double value);

/// For a terminal: without line breaks at its end, and with each other control character as a blank. Files
/// may hold any, and messages quote them.
std::string oneLine(std::string text);

/// What files may hold in a name or a label, for a terminal: control characters, line breaks and escape
/// sequences too, as C would write them (\\n, \\x1b).
std::string printable(const std::string& text);

/// As a field of a CSV table: quoted where it has to be (RFC 4180).
std::string csvField(const std::string& text);

/// A word of a command line, quoted where a shell needs it.
std::string shellWord(const std::string& word);

/// "8x6": two whole numbers with one letter between them, of so many digits at most. Nothing where the text
/// is not like that.
std::optional<std::array<unsigned, 2>> numbersAround(const std::string& text, char between,
                                                     std::size_t most_digits);

}  // namespace fathom
