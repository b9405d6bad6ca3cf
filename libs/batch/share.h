#pragma once

#include <cstddef>
#include <string>

namespace fathom {

/// One machine's share of numbered work: every so-manyth piece, from the so-manyth on. "2/5": of five.
struct Share {
  std::size_t number = 1, of = 1;
  bool has(std::size_t index) const { return index % of == number - 1; }
};

/// Throws Error, which names `option`.
Share shareOf(const std::string& option, const std::string& text);

}  // namespace fathom
