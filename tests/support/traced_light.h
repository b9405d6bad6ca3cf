#pragma once

#include "effects/stages.h"

/// Light's way through ports, by other equations than the program's.
namespace fathom::test {

/// Snell's law for vectors (Glassner 1989): a unit direction through a plane, from index n1 to n2.
Vector3d refracted(const Vector3d& direction, const Vector3d& normal, double n1, double n2);

struct LightRay {
  Vector3d origin, direction;  ///< unit length
};

/// From the camera's centre outwards: the light's way in the water, of what the nominal camera sees along
/// `sight`.
LightRay traced(const FlatPort<double>& port, const Vector3d& sight);
LightRay traced(const DomePort<double>& dome, const Vector3d& sight);

}  // namespace fathom::test
