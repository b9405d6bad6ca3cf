#include "batch/slurm.h"

#include "core/error.h"
#include "core/text.h"

namespace fathom {
namespace {

std::string commandOf(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) command += (command.empty() ? "" : " ") + shellWord(word);
  return command;
}

/// What a line of #SBATCH takes for the end of a path, it does not where that is quoted.
std::string quoted(const std::string& path) { return "\"" + path + "\""; }

}  // namespace

SlurmScripts slurmScripts(const std::vector<std::string>& words, std::size_t shares,
                          const std::string& log_folder, std::size_t cores_a_task) {
  const std::string command = commandOf(words);
  SlurmScripts scripts;
  scripts.array = print(
      "#!/bin/bash\n"
      "#SBATCH --job-name=fathom\n"
      "#SBATCH --array=1-%zu\n"
      "#SBATCH --cpus-per-task=%zu\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --output=%s\n"
      "exec %s --share \"$SLURM_ARRAY_TASK_ID/%zu\" --at-once %zu --no-report\n",
      shares, cores_a_task, quoted(log_folder + "/%A_%a.txt").c_str(), command.c_str(), shares, cores_a_task);
  scripts.collect = print(
      "#!/bin/bash\n"
      "#SBATCH --job-name=fathom-collect\n"
      "#SBATCH --output=%s\n"
      "exec %s --collect\n",
      quoted(log_folder + "/%j_collect.txt").c_str(), command.c_str());
  return scripts;
}

std::string submittedJob(const std::string& printed) {
  // Of its lines the first that is a number, or one with a cluster's name behind a semicolon.
  for (std::size_t begin = 0, end = 0; (end = printed.find('\n', begin)) != std::string::npos;
       begin = end + 1) {
    const std::string line = printed.substr(begin, end - begin);
    std::string number = line.substr(0, line.find(';'));
    if (!number.empty() && number.find_first_not_of("0123456789") == std::string::npos) return number;
  }
  throw Error("sbatch", "", printed.empty() ? "printed nothing" : printed);
}

}  // namespace fathom
