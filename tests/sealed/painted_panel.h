#pragma once

#include <vector>

#include "panel/marker_family.h"
#include "triangle_tree.h"
#include "true_panel.h"

namespace fathom::sealed {

using Eigen::Array3d;

/// Markers' patterns and what they are printed with.
struct Paint {
  explicit Paint(const TruePanel& panel, const SealedCase& sealed);

  /// A rich recording's print is not quite even: 0.5 % (standard deviation), in clouds of some centimetres.
  double evenness(const Vector3d& point_panel) const;

  std::vector<MarkerPattern> patterns;  ///< in the map's order
  std::vector<double> strength;  ///< of each marker's white and black; a rich recording's differ by 0.3 %
  struct Cloud {
    Eigen::Vector2d wave_rad_m;
    double phase_rad;
  };
  std::vector<Cloud> clouds;
};

/// What a line of sight ends on.
struct Sighted {
  double along = 0;  ///< point = origin + along * direction
  int surface = 0;   ///< one number for each colour of each thing; zero: nothing but water
  Array3d albedo = Array3d::Zero();
  Vector3d normal_panel = Vector3d::UnitZ();
};

/// The panel with its markers at one time, to be looked at.
class PaintedPanel {
 public:
  PaintedPanel(const TruePanel& panel, const Paint& paint, double t_s);

  /// Panel frame.
  Sighted along(const Vector3d& origin, const Vector3d& direction) const;

 private:
  struct Face {
    int marker = -1;  ///< index in the map; -1: the body
    int surface = 0;
    Array3d albedo = Array3d::Zero();
    std::array<Eigen::Vector2d, 3> pattern{};  ///< place in the marker's pattern, 0 to 1, from the top left
  };
  void addBody(std::vector<TriangleTree::Triangle>& triangles);
  void addMarker(std::size_t index, double t_s, std::vector<TriangleTree::Triangle>& triangles);
  void colour(const TriangleTree::Hit& hit, const Face& face, Sighted& seen) const;

  const TruePanel& panel_;
  const Paint& paint_;
  std::vector<Face> faces_;
  std::vector<Vector3d> normals_;
  TriangleTree tree_;
};

}  // namespace fathom::sealed
