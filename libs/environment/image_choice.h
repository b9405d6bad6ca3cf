#pragma once

#include <cstddef>
#include <vector>

#include "observables/posed_images.h"

namespace fathom {

struct ImageChoiceOptions {
  std::size_t images = 50;               ///< to fit on, at most
  std::size_t held_out = 24;             ///< to judge on, at most
  std::size_t held_out_every = 4;        ///< of so many stretches of the recording, one is held out
  std::size_t stretches = 24;            ///< at most; of at least five images each
  double largest_position_sigma = 0.01;  ///< of a pose that is good enough, as a share of the range
};

/// Indices into the posed images, ascending.
struct ImageChoice {
  std::vector<std::size_t> fitted, held_out;
  std::size_t too_uncertain = 0;  ///< images whose pose is not good enough
};

/// Images to fit on, spread over range, direction of view and the panel's place in the image (each next one
/// is the farthest from all before, beginning with the nearest to the panel); and others to judge on, spread
/// evenly over stretches of the recording of which none is fitted on. Nothing is random.
ImageChoice chooseImages(const std::vector<PosedImage>& posed, const std::vector<PanelMap>& panels,
                         const ImageChoiceOptions& options = {});

}  // namespace fathom
