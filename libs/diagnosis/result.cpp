#include "diagnosis/result.h"

namespace fathom {

std::string nameOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::none:
      return "none";
    case Verdict::explained:
      return "explained";
    case Verdict::unexplained:
      return "unexplained";
    case Verdict::insufficient:
      break;
  }
  return "insufficient";
}

}  // namespace fathom
