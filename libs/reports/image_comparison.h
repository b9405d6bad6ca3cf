#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"
#include "inputs/batch_recording.h"

/// What a diagnosis made of the images, for people to look at: recorded beside simulated from the same place,
/// without and with what was found.
namespace fathom {

/// A recorded image's simulation, and how alike the two are where panels are; elsewhere nothing is known.
struct SimulatedImage {
  std::string png;  ///< a file's bytes
  std::string
      difference_png;  ///< recorded less simulated: red where the recorded is brighter, blue where darker
  std::optional<double> fsim;
  std::optional<double> rmse_dn;  ///< in linear light
};

struct ComparedImage {
  std::string name;
  double range_m = 0;  ///< camera to the panel
  std::string recorded_png;
  SimulatedImage before;
  std::optional<SimulatedImage> after;  ///< where anything was found
  double scale_dn = 0;                  ///< of both differences: full colour
};

/// The nearest, the farthest and one between. Empty where no pixels were compared. Throws Interrupted.
std::vector<ComparedImage> compareImages(const BatchRecording& recording, const Diagnosis& diagnosis,
                                         const EffectParameters<double>& known);

}  // namespace fathom
