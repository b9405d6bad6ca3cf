#pragma once

#include <cstdint>
#include <vector>

#include "panel/surface.h"

namespace fathom {

/// Whether a triangle has one normal and one albedo.
bool isUniform(const Surface& surface, std::size_t triangle);

/// Between triangles of one face there is no edge to see. One plane (to 10 um) and one normal make a face,
/// along with either one albedo or shared vertices. Returns by triangle, counted from 1, the least triangle
/// of its face; 0 at 0.
std::vector<std::uint32_t> facesOf(const Surface& surface);

}  // namespace fathom
