// diagnose RECORDING.rawlog: which physics the recording shows that the sensors' models leave out.
#include <cstdio>

#include "core/error.h"
#include "effects/catalogue.h"
#include "facade/fathom.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: diagnose RECORDING.rawlog\n");
    return 2;
  }
  try {
    const fathom::Diagnosis diagnosis = fathom::diagnose(fathom::openRecording(argv[1]));
    std::printf("%s: %s\n", fathom::nameOf(diagnosis.verdict).c_str(), diagnosis.why.c_str());
    for (const fathom::FoundEffect& found : diagnosis.effects)
      for (const fathom::EffectEstimate& estimate : found.estimates) {
        const fathom::Parameter& parameter = fathom::parameterOf(estimate.scalar);
        std::printf("%s %s %.4f +- %.4f\n", fathom::allEffects()[estimate.effect].id.data(),
                    parameter.name.data(), fathom::asNamed(parameter, estimate.value),
                    fathom::sigmaAsNamed(parameter, estimate.value, estimate.sigma));
      }
  } catch (const fathom::Error& error) {
    std::fprintf(stderr, "diagnose: %s\n", error.what());
    return 2;
  }
}
