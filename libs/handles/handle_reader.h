#pragma once

#include <string>
#include <vector>

#include "handles/contour.h"
#include "handles/handle_match.h"
#include "handles/straight_edge.h"

/// Task T_H: in which position a panel's handles are, from one image of known pose.
namespace fathom {

struct HandleReading {
  std::size_t handle = 0;  ///< in the map's list
  FrontView view;
  Contour contour;
  EdgeReading edge;   ///< the paper's chain
  HandleMatch match;  ///< by synthesis

  /// An angle is stated; otherwise why_not says why.
  bool confident = false;
  std::string why_not;
  double angle_rad = 0;  ///< the match's, within the handle's range; the chain has its say in whether
  double sigma_rad = 0;
  /// The two ways contradict each other, by so much; NaN where one of them has no angle.
  double disagreement_rad = 0;
};

class HandleReader {
 public:
  explicit HandleReader(HandleScene scene);

  /// Of each handle of the map. From one thread at a time.
  std::vector<HandleReading> read(const PosedPanelImage& image);
  HandleReading read(const PosedPanelImage& image, std::size_t handle);

 private:
  PanelMap map_;
  HandleMatcher matcher_;
};

}  // namespace fathom
