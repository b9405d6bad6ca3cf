#pragma once

#include "core/random.h"
#include "picture.h"

/// What drifts between camera and scene.
namespace fathom::sealed {

/// Marine snow: each flake by itself, at its place in the water, drifting from image to image.
void addSnow(const View& view, const Picture& picture, cv::Mat3f& light);

/// Bubbles that rise before the lens: bright rings, so many in the mean.
void addBubbles(double count, Random& random, const WaterLight& water, cv::Mat3f& light);

}  // namespace fathom::sealed
