#pragma once

#include <string>
#include <vector>

/// A batch on a cluster: a job array whose every task runs a share of it, and a job that collects after all
/// of them (Slurm's sbatch).
namespace fathom {

struct SlurmScripts {
  std::string array;    ///< one task a share
  std::string collect;  ///< after all of them, however they ended
};

/// `words`: the batch's own command, program first, without --slurm; `log_folder` exists. A task whose node
/// is lost is queued again, and takes up where it was.
SlurmScripts slurmScripts(const std::vector<std::string>& words, std::size_t shares,
                          const std::string& log_folder, std::size_t cores_a_task);

/// The number that `sbatch --parsable` prints. Throws Error.
std::string submittedJob(const std::string& printed);

}  // namespace fathom
