#pragma once

#include <map>

#include "diagnosis/saturated.h"

/// Panels are not quite as their maps: markers lie a little elsewhere, print is a little brighter or darker.
namespace fathom {

/// What the panel's markers scatter by about where the map has them; at least what corners are off by however
/// often they are seen. 0: no markers.
struct MarkerScatter {
  double in_face_m = 0;   ///< each axis of the panel's face
  double off_face_m = 0;  ///< out of its plane

  double largest_m() const { return in_face_m > off_face_m ? in_face_m : off_face_m; }
};

/// What the markers' places scatter by beyond their own uncertainty. Panels bend more than prints stretch.
MarkerScatter markerScatter(const Saturated& saturated, const Linearization& linear);

/// What the places' albedos scatter by about those of their kind, beyond what their readings' noise would
/// have them: a share of the albedo. `saturated`: without any such scatter.
double printScatter(const Saturated& saturated, const Linearization& linear);

/// Columns over a linearization's rows of what is estimated too, each with the sigma that holds it.
struct HeldColumns {
  Eigen::SparseMatrix<double> columns;
  Eigen::VectorXd sigma;
};

/// Each marker's own place: where its centre is, how it is turned in the panel's face, and how it is tilted,
/// which moves its corners as far as its centre. `half_sizes_m` by marker id.
HeldColumns placeColumns(const Linearization& linear, const MarkerScatter& scatter,
                         const std::map<int, double>& half_sizes_m);

/// What the light read changes by where a place is printed brighter than the map has it: a column for each
/// place and colour that reflects any, per share of its albedo; weighted as `linear` is.
HeldColumns printColumns(const Linearization& linear, double print_scatter);

}  // namespace fathom
