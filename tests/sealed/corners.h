#pragma once

#include <string>

#include "true_panel.h"
#include "vehicle.h"
#include "viewpoint.h"

namespace fathom::sealed {

/// The corners' table: header, then a row for each marker that a detector would find in the images, which are
/// stamped so and called imageName(0), imageName(1) …
std::string cornersTable(const Vehicle& vehicle, const SealedCase& sealed, const TruePanel& panel,
                         const Viewpoint& viewpoint, const std::vector<double>& stamps_s);

std::string imageName(std::size_t index);

}  // namespace fathom::sealed
