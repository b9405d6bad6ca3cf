#include "recording/imported.h"

#include <cstdio>

namespace fathom {

std::string toText(const Conclusion& conclusion) {
  std::string text = conclusion.what + ": " + conclusion.concluded;
  if (!conclusion.runner_up.empty()) {
    char ratio[32];
    std::snprintf(ratio, sizeof ratio, "%.3g", conclusion.residual_ratio);
    text += " (residual ratio " + std::string(ratio) + " against: " + conclusion.runner_up + ")";
  }
  return conclusion.evidence.empty() ? text : text + "; " + conclusion.evidence;
}

}  // namespace fathom
