// simulate_effect TRAJECTORY.yaml VEHICLE.yaml FOLDER: a dive whose DVL reads 3 % too much, since it assumes
// a sound speed that is not the water's.
#include <cstdio>

#include "core/error.h"
#include "facade/fathom.h"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: simulate_effect TRAJECTORY.yaml VEHICLE.yaml FOLDER\n");
    return 2;
  }
  try {
    fathom::SimulatedDive dive;
    dive.effects.add<fathom::DvlScale>({0.03});
    dive.seed = 7;
    const fathom::RecordingFiles files = fathom::simulate(argv[1], argv[2], argv[3], dive);
    std::printf("%s\n", files.rawlog.c_str());
  } catch (const fathom::Error& error) {
    std::fprintf(stderr, "simulate_effect: %s\n", error.what());
    return 2;
  }
}
