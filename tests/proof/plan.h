#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <vector>

#include "programs.h"
#include "proof_case.h"

namespace fathom::proof {

/// How much of a proof.
struct Extent {
  std::size_t corner_dives = 6, image_dives = 5;
  std::vector<double> strata{3, 5, 8, 16, 32};  ///< sqrt(lambda)
  std::size_t each = 1;                         ///< of each effect in each stratum
  std::size_t every = 1;                        ///< of the effects, only every so-manyth
  std::size_t pairs = 40, nulls = 100, outside = 30, intervals = 40;
  std::size_t decoy_dives = 5, decoys_a_dive = 8;
  std::uint64_t first_seed = 1;
  /// Imperfections that every recording has, in units of the generator's: within the error budget.
  double ordinary = 0;
  std::set<ProofCase::Kind> kinds;  ///< empty: all. What a case is does not depend on it

  bool has(ProofCase::Kind kind) const { return kinds.empty() || kinds.contains(kind); }
};
Extent wholeProof();
/// A sample of it that a continuous integration has time for.
Extent quickProof();

/// The recordings, in a fixed order; sizes of effects are such that sqrt(lambda) is as each stratum asks.
/// Makes and reads recordings of each dive that hide nothing, in `folder`. Throws Error, Interrupted.
std::vector<ProofCase> planProof(const Extent& extent, const Programs& programs,
                                 const std::filesystem::path& folder);

}  // namespace fathom::proof
