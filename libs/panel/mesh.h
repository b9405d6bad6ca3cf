#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "panel/surface.h"

namespace fathom {

/// A Wavefront OBJ file, with the linear albedo of its materials.
struct Mesh {
  Surface surface;                     ///< flat faces
  std::vector<std::string> materials;  ///< in use, sorted
  int components = 0;                  ///< connected pieces
};

/// Reads an OBJ (OpenMesh) and the colours Kd of its .mtl (ourselves: OpenMesh rounds them to 8 bits).
/// `left_out` names objects (`o NAME` or `g NAME` lines) that are checked, but not part of the result.
/// Throws Error, which names the line, where the file or its material library is missing or damaged, a face
/// has no material or no area or is not convex and plane, an edge or vertex is not manifold, faces are turned
/// against their neighbours, a closed piece is inside out, or the size is no panel's in metres (1 cm to 20
/// m).
Mesh readMesh(const std::filesystem::path& file, const std::set<std::string>& left_out = {});

}  // namespace fathom
