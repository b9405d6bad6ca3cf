#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// A batch: recordings x tasks x settings, as a list of commands.
namespace fathom {

/// One command of it.
struct BatchJob {
  std::string name;  ///< of its folder: "dive.improved.seed1"
  std::filesystem::path recording;
  std::string run;
  std::optional<std::uint64_t> seed;
  std::vector<std::string> words;  ///< "localize", RECORDING, options; neither the program nor --out
};

/// A number, or a word, that is taken from each job's result.json.
struct BatchColumn {
  std::string name;  ///< with unit
  std::string at;    ///< JSON pointer (RFC 6901)
};

struct BatchPlan {
  std::vector<BatchJob> jobs;  ///< recording by recording, run by run, seed by seed
  std::vector<BatchColumn> columns;
};

/// See config/batch.yaml. A folder among the recordings stands for all rawlogs in it, at any depth, but those
/// of results; paths are as in a command typed where the program runs. Throws Error: also where there is no
/// recording, or two jobs would be alike.
BatchPlan readBatchPlan(const std::filesystem::path& config);

}  // namespace fathom
