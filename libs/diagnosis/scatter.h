#pragma once

#include <cmath>
#include <map>
#include <vector>

#include "estimation/linearization.h"

/// Panels are not quite as their maps: markers lie a little elsewhere, print is a little brighter or darker.
namespace fathom {

/// What the panel's markers scatter by about where the map has them; at least what corners are off by however
/// often they are seen. 0: no markers.
struct MarkerScatter {
  double in_face_m = 0;   ///< each axis of the panel's face
  double off_face_m = 0;  ///< out of its plane
  double tilted_m = 0;    ///< their corners, about that: how they are tilted; 0: are not

  double largest_m() const { return in_face_m > off_face_m ? in_face_m : off_face_m; }
  /// Of an axis.
  double rms_m() const { return std::sqrt((2 * in_face_m * in_face_m + off_face_m * off_face_m) / 3); }
};

/// What of a panel is printed a little otherwise than the map has it.
enum class Printed { black, white, body, edges };

/// What the panel's places scatter by, for good: about the albedos that the map has for their kind, as shares
/// of these, and of markers what their edges are softer by than they are rendered. 0: not to be seen.
struct PrintScatter {
  double black = 0, white = 0, body = 0;
  double parts = 0;      ///< what half of a place differs by from all of it; see partVariance()
  double edges_px2 = 0;  ///< of the variance along either axis of the image

  double of(Printed what) const {
    switch (what) {
      case Printed::black:
        return black;
      case Printed::white:
        return white;
      case Printed::body:
        return body;
      case Printed::edges:
        return edges_px2;
    }
    return 0;
  }
  bool isSeen() const { return black > 0 || white > 0 || body > 0 || edges_px2 > 0; }
};

/// What a camera by itself sees through may be whole pixels from what is nominal, which is far from linear:
/// then markers seem to lie elsewhere in all directions, and would make up for nearly all of it were they
/// free.
bool isCameraAlone(const Linearization& linear);

/// The variance, in units of the row's noise, by which a place that is seen in part reads otherwise than all
/// of it would, were `parts` 1: of the mean over a part of what varies over short distances, about the mean
/// over all of it. 0: is no patch of a panel.
double partVariance(const RowInfo& row);

/// A place's readings in one colour, or of a marker's edges along one axis, by row.
struct PrintedPlace {
  Printed what;
  int component;
  std::vector<std::size_t> rows;
};
std::vector<PrintedPlace> printedPlaces(const Linearization& linear);
/// What a row changes by, in units of its noise, as it is weighted, where its place is as much brighter as
/// its albedo is, or its edges softer by 1 px².
double sigmasPerUnit(const RowInfo& row);
/// The same of each place's rows, a column a place.
Eigen::SparseMatrix<double> columnsOf(const Linearization& linear, const std::vector<PrintedPlace>& places);

/// Of MarkerMoved's columns the one out of the face.
inline constexpr Eigen::Index kOffFace = 2;

/// Columns over a linearization's rows of what is estimated too, each with the sigma that holds it.
struct HeldColumns {
  Eigen::SparseMatrix<double> columns;
  Eigen::VectorXd sigma;
};

/// Each marker's own place: where its centre is, how it is turned in the panel's face, and how it is tilted.
/// `half_sizes_m` by marker id.
HeldColumns placeColumns(const Linearization& linear, const MarkerScatter& scatter,
                         const std::map<int, double>& half_sizes_m);

/// What the light read changes by where a place is printed brighter than the map has it, and a marker's edges
/// by where they are softer: a column for each place and colour that scatters, per share of its albedo, and
/// for each marker and axis, per px²; weighted as `linear` is.
HeldColumns printColumns(const Linearization& linear, const PrintScatter& scatter);

}  // namespace fathom
