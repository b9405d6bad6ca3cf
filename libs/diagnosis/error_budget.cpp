#include "diagnosis/error_budget.h"

#include <cmath>

namespace fathom {
namespace {

constexpr double kSigmasOf99 = 2.576;  // of a normal variable, two-sided

}  // namespace

double VarianceComponent::logSd() const { return std::log(factor) / kSigmasOf99; }

}  // namespace fathom
