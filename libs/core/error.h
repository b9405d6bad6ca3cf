#pragma once

#include <stdexcept>
#include <string>

namespace fathom {

/// Bad input: says which file, where in it (key, line or byte offset), and why.
/// Thrown anywhere, caught once, in main, which prints what(), which is one line, and exits with status 2.
class Error : public std::runtime_error {
 public:
  Error(std::string file_in, std::string where_in, std::string why_in);

  std::string file;   ///< path, or option name for a bad command line
  std::string where;  ///< key, line or byte offset; may be empty
  std::string why;
};

}  // namespace fathom
