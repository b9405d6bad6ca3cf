#include "core/error.h"

#include "core/text.h"

namespace fathom {

Error::Error(std::string file_in, std::string where_in, std::string why_in)
    : std::runtime_error(oneLine(file_in + (where_in.empty() ? "" : ": " + where_in) + ": " + why_in)),
      file(std::move(file_in)),
      where(std::move(where_in)),
      why(std::move(why_in)) {}

}  // namespace fathom
