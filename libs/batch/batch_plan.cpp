#include "batch/batch_plan.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/files.h"
#include "core/yaml.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

bool isRecording(const fs::path& file) {
  return file.extension() == ".rawlog" && !file.stem().string().ends_with("_results");
}

std::vector<fs::path> recordingsIn(const fs::path& place, const std::string& config) {
  if (!isThere(place)) throw Error(config, "recordings", place.string() + " is not there");
  if (!isFolder(place)) return {place};
  std::vector<fs::path> files;
  std::error_code problem;
  for (fs::recursive_directory_iterator at(place, problem), end; !problem && at != end; at.increment(problem))
    if (isRecording(at->path()) && isFile(at->path())) files.push_back(at->path());
  if (problem)
    throw Error(config, "recordings", place.string() + " cannot be searched: " + problem.message());
  if (files.empty()) throw Error(config, "recordings", "no rawlog is in " + place.string());
  std::sort(files.begin(), files.end());
  return files;
}

/// As many folders of the recording's path as tell it from the others, joined to one name.
std::vector<std::string> shortNames(const std::vector<fs::path>& recordings) {
  for (int depth = 1;; ++depth) {
    std::vector<std::string> names;
    bool deeper = false;
    for (const fs::path& recording : recordings) {
      std::string name = recording.stem().string();
      fs::path folder = recording.parent_path();
      for (int d = 1; d < depth && folder.has_filename(); ++d, folder = folder.parent_path())
        name.insert(0, folder.filename().string() + "-");
      deeper = deeper || folder.has_filename();
      names.push_back(name);
    }
    const bool differ = std::set(names.begin(), names.end()).size() == names.size();
    if (differ || !deeper) return names;
  }
}

struct Run {
  std::string name, command;
  std::vector<std::string> options;
  std::vector<std::optional<std::uint64_t>> seeds{std::nullopt};
};

Run readRun(const YamlMap& y) {
  Run run;
  run.name = y.text("name");
  const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
  if (run.name.empty() || run.name.find_first_not_of(plain) != std::string::npos)
    throw y.error("name", "must be letters, digits, - and _: it names folders");
  run.command = y.text("command");
  if (y.has("options")) run.options = y.texts("options");
  if (std::find(run.options.begin(), run.options.end(), "--out") != run.options.end())
    throw y.error("options", "--out is the batch's to say");
  if (!y.has("seeds")) return run;
  run.seeds.clear();
  for (const double seed : y.numbers("seeds")) {
    if (!(seed >= 0 && seed < 1e15) || seed != static_cast<double>(static_cast<std::uint64_t>(seed)))
      throw y.error("seeds", "must be whole numbers from 0 on");
    run.seeds.emplace_back(static_cast<std::uint64_t>(seed));
  }
  if (run.seeds.empty()) throw y.error("seeds", "is empty");
  return run;
}

BatchColumn readColumn(const YamlMap& y) {
  BatchColumn column{y.text("name"), y.text("at")};
  try {
    static_cast<void>(nlohmann::json::json_pointer(column.at));
  } catch (const nlohmann::json::exception&) {
    throw y.error("at", "must be a JSON pointer, as /tasks/TL2/m_A");
  }
  return column;
}

BatchJob jobOf(const fs::path& recording, const std::string& recording_name, const Run& run,
               const std::optional<std::uint64_t>& seed) {
  BatchJob job{recording_name + "." + run.name, recording, run.name, seed, {run.command, recording.string()}};
  job.words.insert(job.words.end(), run.options.begin(), run.options.end());
  if (!seed) return job;
  job.name += ".seed" + std::to_string(*seed);
  job.words.insert(job.words.end(), {"--seed", std::to_string(*seed)});
  return job;
}

}  // namespace

BatchPlan readBatchPlan(const fs::path& config) {
  const YamlFile yaml(config);
  const YamlMap& y = yaml.root();
  std::vector<fs::path> recordings;
  for (const std::string& place : y.texts("recordings"))
    for (const fs::path& file : recordingsIn(place, config.string())) recordings.push_back(file);
  if (recordings.empty()) throw y.error("recordings", "there are none");
  std::vector<Run> runs;
  for (const YamlMap& run : y.maps("runs")) runs.push_back(readRun(run));
  if (runs.empty()) throw y.error("runs", "there are none");
  BatchPlan plan;
  if (y.has("columns"))
    for (const YamlMap& column : y.maps("columns")) plan.columns.push_back(readColumn(column));
  yaml.rejectUnknownKeys();

  const std::vector<std::string> names = shortNames(recordings);
  std::set<std::string> taken;
  for (std::size_t i = 0; i < recordings.size(); ++i)
    for (const Run& run : runs)
      for (const auto& seed : run.seeds) {
        plan.jobs.push_back(jobOf(recordings[i], names[i], run, seed));
        if (!taken.insert(plan.jobs.back().name).second)
          throw Error(config.string(), "runs", plan.jobs.back().name + " is there twice");
      }
  return plan;
}

}  // namespace fathom
