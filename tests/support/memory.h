#pragma once

#include <fstream>
#include <string>

namespace fathom::test {

/// The most memory that this process has had, resident.
inline double peakMegabytes() {
  std::ifstream status("/proc/self/status");
  double kilobytes = 0;
  for (std::string word; status >> word;)
    if (word == "VmHWM:") status >> kilobytes;
  return kilobytes / 1024.0;
}

}  // namespace fathom::test
