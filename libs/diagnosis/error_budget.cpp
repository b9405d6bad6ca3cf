#include "diagnosis/error_budget.h"

#include <cmath>
#include <tuple>
#include <vector>

namespace fathom {

ErrorBudget ErrorBudget::of(CameraPipeline pipeline) const {
  ErrorBudget own = *this;
  if (pipeline != CameraPipeline::processed) {
    std::erase_if(own.components, [](const VarianceComponent& c) { return c.of_processed_only; });
  } else {
    for (VarianceComponent& c : own.components) {
      if (c.processed) std::tie(c.sigma, c.factor) = std::tie(c.processed->sigma, c.processed->factor);
      c.is_as_shown = c.processed || c.of_processed_only;
    }
  }
  return own;
}

double VarianceComponent::logSd() const { return std::log(factor) / kSigmasOf99; }

}  // namespace fathom
