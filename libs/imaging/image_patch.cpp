#include "imaging/image_patch.h"

namespace fathom {

template Vector3<double> predictPatchLight(const PatchSurface&, const double&, const double&,
                                           const SceneLight<double>&, const PatchUnderLamps<double>&,
                                           const Vector9<double>&, const EffectParameters<double>&, double,
                                           const SightInScene<double>&);
template Vector3<double> predictPatch(const KinematicState<double>&, PanelPlacement<double>,
                                      const ImagePatch&, const std::vector<LampSheet>&,
                                      const Vector9<double>&, const EffectParameters<double>&, double);

}  // namespace fathom
