#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tuning/innovation_score.h"

namespace fathom {

/// One size of the noise, as a factor on what options and vehicle file have.
struct NoiseParameter {
  std::string name, unit;
  double value = 0.0;  ///< before, in its unit; of a density, its square root
  std::function<void(LocalizationOptions& options, double factor)> multiply;
  std::optional<Channel> seen_by{};  ///< whose innovations are as large as it is
};

/// What a recording can tell: the drive of each regime in which it spends some time, the sigma of each
/// channel it has, the INS's biases. `options` has them all written out (see writtenOut()).
std::vector<NoiseParameter> noiseParameters(const LocalizationOptions& options, const Vehicle& vehicle,
                                            const Scores& scores);

/// The same options with everything written out that a vehicle file or another section stands for: a drive
/// for each of these regimes, the biases.
LocalizationOptions writtenOut(LocalizationOptions options, const Vehicle& vehicle, const Scores& scores);

}  // namespace fathom
