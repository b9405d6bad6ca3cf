#include "depth_gauge.h"

#include "streams.h"

namespace fathom::sealed {

PressureSensor::PressureSensor(const Vehicle& vehicle, const SealedCase& sealed, const Dive& dive)
    : vehicle_(vehicle),
      sealed_(sealed),
      dive_(dive),
      random_(stream(sealed.seed, Stream::depth)),
      zero_error_pa_(sealed.noise ? vehicle.depth.pressure_offset_sigma_pa * random_.normal() : 0.0) {}

DepthSample PressureSensor::read(double t_s) {
  const Pose T_robot_depth = vehicle_.depth.pose.pose();
  Vector3d place_robot = T_robot_depth.position;
  if (sealed_.find("pressure-lever-arm", t_s))
    place_robot += sealed_.vector("pressure-lever-arm", "offset_m", t_s);
  const double depth_m = -(dive_.poseAt(sealed_.trueTime_s(labels::kDepth, t_s)) * place_robot).z();
  const double density_kg_m3 =
      vehicle_.depth.water_density_kg_m3 + sealed_.number("pressure-density", "density_error_kg_m3", t_s);
  double pressure_pa = vehicle_.depth.atmospheric_pressure_pa +
                       density_kg_m3 * vehicle_.gravity_m_s2 * depth_m + zero_error_pa_ +
                       sealed_.number("pressure-offset", "offset_pa", t_s);
  if (sealed_.noise) pressure_pa += vehicle_.depth.pressure_sigma_pa * random_.normal();
  return {T_robot_depth, pressure_pa, {}};
}

}  // namespace fathom::sealed
