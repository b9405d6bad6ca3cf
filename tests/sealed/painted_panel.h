#pragma once

#include <set>
#include <vector>

#include "panel/marker_family.h"
#include "triangle_tree.h"
#include "true_panel.h"

namespace fathom::sealed {

using Eigen::Array3d;

/// Markers' patterns and what they are printed with.
struct Paint {
  explicit Paint(const TruePanel& panel, const SealedCase& sealed);

  /// A rich recording's print is not quite even: 0.5 % (standard deviation), in clouds of some centimetres;
  /// an ordinary one's as kOrdinary says.
  double evenness(const Vector3d& point_panel) const;
  /// The print's albedo below a film of growth, where the marker has one: it lets a part of the print show.
  Array3d overgrown(std::size_t marker, const Vector3d& point_panel, const Array3d& print, double t_s) const;

  std::vector<MarkerPattern> patterns;  ///< in the map's order
  std::vector<double> strength;  ///< of each marker's white and black; a rich recording's differ by 0.3 %
  struct Cloud {
    Eigen::Vector2d wave_rad_m;
    double phase_rad;
  };
  std::vector<Cloud> clouds;
  FieldTable albedo_field, growth_field;
  std::set<std::size_t> grown;  ///< markers, by their place in the map

 private:
  struct Film {
    double cover = 0;
    Array3d albedo = Array3d::Zero();
  };
  Film filmOn(std::size_t marker, double t_s) const;
  const SealedCase& sealed_;
  std::vector<int> ids_;

  void coverGrowth(const SealedCase& sealed);
};

/// What a line of sight ends on.
struct Sighted {
  enum class Print { none, black, white };

  double along = 0;  ///< point = origin + along * direction
  int surface = 0;   ///< one number for each colour of each thing; zero: nothing but water
  Array3d albedo = Array3d::Zero();
  Print print = Print::none;
  std::size_t triangle = 0;
  Vector3d normal_panel = Vector3d::UnitZ();
  double illumination = 1;  ///< fraction of the daylight that it gets
};

/// The panel with its markers at one time, to be looked at.
class PaintedPanel {
 public:
  PaintedPanel(const TruePanel& panel, const Paint& paint, double t_s);

  /// Panel frame.
  Sighted along(const Vector3d& origin, const Vector3d& direction) const;
  /// The same of a line right beside one that ended on `seen`: on a marker's plane, white all round it.
  Sighted beside(const Sighted& seen, const Vector3d& origin, const Vector3d& direction) const;

 private:
  struct Face {
    int marker = -1;  ///< index in the map; -1: the body
    int surface = 0;
    Array3d albedo = Array3d::Zero();
    std::array<Eigen::Vector2d, 3> pattern{};  ///< place in the marker's pattern, 0 to 1, from the top left
  };
  void addBody(std::vector<TriangleTree::Triangle>& triangles);
  void addMarker(std::size_t index, std::vector<TriangleTree::Triangle>& triangles);
  Sighted sighted(const TriangleTree::Hit& hit, const Vector3d& origin, const Vector3d& direction) const;
  void colour(const TriangleTree::Hit& hit, const Face& face, Sighted& seen) const;

  const TruePanel& panel_;
  const Paint& paint_;
  double t_s_;
  std::vector<TriangleTree::Triangle> triangles_;
  std::vector<Face> faces_;
  std::vector<Vector3d> normals_;
  TriangleTree tree_;
};

}  // namespace fathom::sealed
