#include "batch/share.h"

#include <regex>

#include "core/error.h"

namespace fathom {

Share shareOf(const std::string& option, const std::string& text) {
  std::smatch parts;
  if (!std::regex_match(text, parts, std::regex("([0-9]{1,9})/([0-9]{1,9})")))
    throw Error(option, text, "is not of the form 2/5");
  const Share share{std::stoul(parts[1]), std::stoul(parts[2])};
  if (share.number < 1 || share.number > share.of) throw Error(option, text, "is not of the form 2/5");
  return share;
}

}  // namespace fathom
