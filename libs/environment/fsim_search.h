#pragma once

#include <functional>

#include "imaging/water.h"

namespace fathom {

struct FsimSearchOptions {
  std::size_t evaluations = 120;  ///< of a water, at most
  double first_factor = 2;        ///< of attenuation, and of the veil, to both sides
  double last_factor = 1.02;      ///< a step that is smaller is not tried
};

struct FsimSearch {
  Environment environment;
  double similarity = 0;  ///< its mean
  std::size_t evaluations = 0;
};

/// The paper's way to a water, which was done by hand: attenuation and veil of each channel are turned up and
/// down, what makes the images more alike is kept, and the step is halved (its factor's root taken) where
/// nothing does. Ambient light stays the start's. `similarity` is the mean FSIM of some images.
FsimSearch searchByFsim(const Environment& start, const std::function<double(const Environment&)>& similarity,
                        const FsimSearchOptions& options = {});

}  // namespace fathom
