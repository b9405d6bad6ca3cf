#pragma once

#include <functional>
#include <vector>

#include "core/affine.h"
#include "localization/measurements.h"
#include "localization/setup.h"
#include "recording/samples.h"

/// Readings taken back through the sensors' models to what they tell of the robot. Used within this room
/// only.
namespace fathom {

/// What a measurement is taken at: its channel, its entry's time, the instant's nominal state.
struct Seen {
  Channel channel;
  const Observation& observation;
  const Vehicle& vehicle;
  const Inputs<double>& at;

  /// What `field` of the inputs was, from what was measured: models are affine in it, effects included. In as
  /// many components as the measurement has, from `first` on.
  using Field = std::function<void(Inputs<double>&, const Vector3d&)>;
  Vector3d where(const Field& field, int first = 0) const {
    return observation.value.size() == 1 ? where<1>(field, first) : where<3>(field, first);
  }

 private:
  template <int N>
  Vector3d where(const Field& field, int first) const {
    using Part = Eigen::Matrix<double, N, 1>;
    const auto whole = [first](const Part& part) {
      Vector3d value = Vector3d::Zero();
      value.segment<N>(first) = part;
      return value;
    };
    const auto model = [&](const Part& part) {
      Inputs<double> in = at;
      field(in, whole(part));
      return Part(modelOf(channel).predict(in, vehicle, observation));
    };
    return whole(affineInverse<N>(model, Part(observation.value)));
  }
};

/// Every measurement of the samples, with the calibration's effects at its time.
void forEachSeen(const LocalizationSetup& setup, const std::vector<Sample>& samples,
                 const KinematicState<double>& state, const std::function<void(const Seen&)>& f);

}  // namespace fathom
