#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

/// What OpenMesh's OBJ reader does not tell of a file, or takes on trust.
namespace fathom {

struct ObjFace {
  int line = 0;
  std::vector<int> corners;  ///< vertices, counted from 0
  std::string object, material;
};

struct ObjOutline {
  int vertices = 0;
  std::vector<ObjFace> faces;
  std::map<std::string, Eigen::Vector3f> albedo;  ///< Kd of each material
};

/// Throws Error for: a vertex that is not three finite numbers, a face with a vertex that is missing or named
/// twice or with fewer than three, a face without a material, a missing or damaged material library.
ObjOutline readObjOutline(const std::filesystem::path& file);

}  // namespace fathom
