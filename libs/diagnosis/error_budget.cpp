#include "diagnosis/error_budget.h"

#include <cmath>

namespace fathom {

double VarianceComponent::logSd() const { return std::log(factor) / kSigmasOf99; }

}  // namespace fathom
