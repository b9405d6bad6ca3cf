#include "batch/share.h"

#include "core/error.h"
#include "core/text.h"

namespace fathom {

Share shareOf(const std::string& option, const std::string& text) {
  const auto numbers = numbersAround(text, '/', 9);
  if (!numbers) throw Error(option, text, "is not of the form 2/5");
  const Share share{(*numbers)[0], (*numbers)[1]};
  if (share.number < 1 || share.number > share.of) throw Error(option, text, "is not of the form 2/5");
  return share;
}

}  // namespace fathom
