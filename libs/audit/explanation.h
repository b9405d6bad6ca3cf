#pragma once

#include <functional>
#include <vector>

#include "audit/agreement.h"

namespace fathom {

/// A fault of drivers, and by how much streams agree better without it.
struct Explanation {
  DriverFault fault;
  Agreement::Differences differences;
  std::array<double, Agreement::kRelations> gains{};
  double gain = 0;           ///< in log likelihood, its prior included
  double witnessed = 0;      ///< of it by streams that differ, not by what robots usually do
  double largest_ratio = 1;  ///< of squares, before and after
  bool agrees = true;        ///< all streams then, as healthy ones do: else something else is wrong, too

  /// So good that physics leave no other: much more likely, a relation's difference half of what it was or
  /// less, and all streams agree then.
  bool isSure() const;
};

/// What is compared, and which faults may be in it.
struct ExplanationSearch {
  const Agreement& agreement;  ///< as the streams stand
  const InsStream& ins;
  const DvlStream* dvl;  ///< null: none
  std::vector<DriverFault> faults;
  bool vectors_in_world = false;  ///< they may be turned into the world already; there is an attitude
  bool dvl_turned = false;        ///< by any angle about its z axis
  bool clock_off = false;         ///< the DVL's or the INS's may be
  /// Of other streams in place of those.
  std::function<Agreement(const InsStream&, const DvlStream*)> agreementOf;
};

/// The best and those that the streams do not tell from it, best first; none where nothing is enough better
/// than no fault. Likelihoods are Gaussian with unknown sigma, floors and weights those of the relations.
std::vector<Explanation> explanationsOf(ExplanationSearch search);

}  // namespace fathom
