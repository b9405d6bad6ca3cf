#include "localization/seen.h"

#include "recording/instrument_entries.h"

namespace fathom {

void forEachSeen(const LocalizationSetup& setup, const std::vector<Sample>& samples,
                 const KinematicState<double>& state, const std::function<void(const Seen&)>& f) {
  Inputs<double> at{state, {setup.vehicle.gravityOdom()}, {}};
  for (const Sample& sample : samples) {
    at.t_s = secondsBetween(setup.time_zero, sample.time);
    forEachObservation(sample, setup.vehicle, [&]<class C>(const Observation& observation) {
      Inputs<double> own = at;
      own.effects = setup.calibration.of(observation.instance);
      f(Seen{kChannel<C>, observation, setup.vehicle, own});
    });
  }
}

}  // namespace fathom
