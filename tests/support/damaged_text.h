#pragma once

#include <string>

#include "core/random.h"

namespace fathom::test {

/// A text with one thing wrong: a character, its end, a piece missing, a piece twice.
inline std::string damaged(std::string text, Random& random) {
  const auto at = random.bits() % text.size();
  switch (random.bits() % 5) {
    case 0:
      text[at] = static_cast<char>(random.bits());
      break;
    case 1:
      text.resize(at);
      break;
    case 2:
      text.erase(at, 1 + random.bits() % 20);
      break;
    case 3:
      text.insert(at, text.substr(random.bits() % text.size(), random.bits() % 30));
      break;
    default:
      text[at] = "0123456789-+./e\n #{}[]:,"[random.bits() % 24];
      break;
  }
  return text;
}

}  // namespace fathom::test
