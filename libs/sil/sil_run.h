#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sil/pair_maker.h"
#include "sil/pair_picture.h"
#include "sil/pair_store.h"
#include "similarity/measures.h"

/// Simulation in the loop: the paper's Algorithm 1 over a whole recording. For every image, markers -> panel
/// pose -> robot pose -> render at that pose -> pair <real, simulated> -> measures.
namespace fathom {

struct SilOptions {
  PairOptions pairs;
  DetectionSettings detection;        ///< of the recorded images, and again of the simulated ones
  std::vector<std::string> measures;  ///< ids; empty: all (similarity/measures.h)
  std::size_t every = 1;              ///< of the recording's images, each so many-th
  ResidualScale residual;
  bool frames = false;  ///< each pair as a picture
  bool video = true;
};

/// Where outputs go. In `folder`: NAME_pairs.rawlog, NAME_pairs_Images/, NAME_pairs.avi, NAME_frames/.
struct SilTarget {
  std::filesystem::path recording;  ///< for complaints
  std::filesystem::path folder;
  std::string name;
  RecordingHeader header;  ///< of the rawlog
};

/// A quantity's column in tables.
struct SilColumn {
  std::string name;  ///< fsim, detection_agreement_corner_rms, …
  std::string unit;  ///< "1" where it has none
  Better better;
  std::size_t measure;  ///< among the run's
};

struct SilPairResult {
  PosedImage posed;
  PairRecord record;
};

struct SilResults {
  std::vector<SilColumn> columns;
  std::vector<std::string> measures;  ///< ids
  std::vector<SilPairResult> pairs;   ///< in order of time
  std::vector<UnposedImage>
      unpaired;                ///< those of the recording without a pose, and those that did not fit it
  std::size_t taken_over = 0;  ///< pairs of an earlier run
};

/// Makes and measures all pairs, several at a time; hands them on in their order, so that memory does not
/// depend on how many there are (but for some hundred bytes each). The rawlog has three entries a pair:
/// CAMERA and SIMULATED, images, and MARKERS, where the robot was. Results are the same, byte by byte, on
/// however many threads.
///
/// What is finished stays finished: an interrupted run goes on, and a later one takes over those pairs that
/// come of the same inputs. Files appear under their names when whole, the rawlog last.
///
/// Throws Error: an unknown measure; none of the images can be paired. Interrupted.
SilResults runSil(const PosedImages& images, const PairMaker& maker, const SilOptions& options,
                  const SilTarget& target);

/// Pairs spread evenly over range, nearest first, as they were stored: recorded, simulated, residual.
cv::Mat silSheet(const SilResults& results, const PairMaker& maker, const SilOptions& options,
                 const SilTarget& target, std::size_t count = 8);

}  // namespace fathom
