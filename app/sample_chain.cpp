#include "sample_chain.h"

#include "core/error.h"
#include "effects/calibration.h"
#include "inputs.h"
#include "sources/make_source.h"

namespace fathom {

SampleChain::SampleChain(const ChainOptions& options, bool landmarks) : options_(options) {
  auto source = openBare();
  const auto vehicle = vehicleFile(options.vehicle, options.rawlog, source->header());
  if (!vehicle)
    throw Error(options.rawlog.string(), "",
                "names no vehicle file in its first comment; give one with --vehicle");
  setup_.vehicle = readVehicle(*vehicle);
  if (!options.calibration.empty()) setup_.calibration = readCalibration(options.calibration);
  remarks_ = disagreements(inspectRecording(options.rawlog), setup_.vehicle);
  setup_.time_zero = source->next()->time;
  (void)landmarks;
}

std::unique_ptr<SampleSource> SampleChain::openBare() const {
  if (!options_.sources.empty()) return makeSource(options_.sources, options_.rawlog);
  return std::make_unique<RecordingSource>(options_.rawlog);
}

std::unique_ptr<SampleSource> SampleChain::open() const { return openBare(); }

}  // namespace fathom
