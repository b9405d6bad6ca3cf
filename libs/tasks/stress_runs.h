#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "core/chi_square.h"
#include "localization/evaluation.h"
#include "localization/localizer.h"
#include "recording/sample_source.h"
#include "sources/stress.h"

namespace fathom {

/// What a fault of one strength did to a task.
struct StressRun {
  std::string fault;  ///< "none": the recording as it is
  std::string vary;
  double strength = 0;

  LocalizationSummary summary;
  std::vector<PoseError> errors;   ///< against the reference, in time order
  std::vector<bool> lost;          ///< of each error, whether the estimate was said to be lost
  std::vector<Event> events;       ///< lost, found, reacquired, panel-moved
  double largest_unflagged_m = 0;  ///< position error where it was not said to be lost
  double lost_s = 0;               ///< time it was said to be lost
  double longest_silent_s = 0;     ///< outside its own bounds for so long without saying so
  double final_error_m = 0;        ///< at the end

  enum class Outcome {
    unharmed,   ///< inside its bounds all along, but for kChance_s in a row
    recovered,  ///< outside them, or said to be lost, for a while; at the end neither
    lost,       ///< says at the end that it is lost, and since when
    silent,     ///< outside its bounds at the end without saying so
    not_started,
  };
  Outcome outcome = Outcome::not_started;
};
std::string nameOf(StressRun::Outcome outcome);

/// A filter is outside its bounds where the pose's NEES exceeds this: once in 10 000 by chance.
inline const double kStressBound = chiSquareQuantile(6, 0.9999);
inline constexpr double kChance_s = 1.0;  ///< or for so long: errors a moment apart are alike

/// Runs the task without fault and with each fault at each strength, all cores at once. `open` makes a new
/// source of the recording, landmarks and all; it is called from several threads. Results are in the order of
/// the faults. Throws what the source throws; Interrupted.
std::vector<StressRun> runStress(const LocalizationSetup& setup,
                                 const std::function<std::unique_ptr<SampleSource>()>& open,
                                 const std::vector<StampedPose>& reference,
                                 const std::vector<StressFault>& faults);

}  // namespace fathom
