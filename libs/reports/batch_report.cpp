#include "reports/batch_report.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files.h"
#include "core/text.h"
#include "evaluation/statistics.h"
#include "report/html_report.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using State = JobOutcome::State;

const char* nameOf(State state) {
  return state == State::done ? "done" : state == State::failed ? "failed" : "open";
}

/// What a column finds in a job's result; null where it is not there.
Json valueOf(const JobOutcome& outcome, const BatchColumn& column) {
  const Json::json_pointer at(column.at);
  return outcome.result.contains(at) ? outcome.result.at(at) : Json();
}

std::string textOf(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return value.get<std::string>();
  return value.is_number_float() ? shortest(value.get<double>()) : value.dump();
}

std::vector<std::string> runsOf(const BatchStory& story) {
  std::vector<std::string> runs;
  for (const BatchJob& job : story.plan.jobs)
    if (std::find(runs.begin(), runs.end(), job.run) == runs.end()) runs.push_back(job.run);
  return runs;
}

/// Calls use(job, outcome) for each of a run.
template <class Use>
void forEachOf(const BatchStory& story, const std::string& run, const Use& use) {
  for (std::size_t i = 0; i < story.plan.jobs.size(); ++i)
    if (story.plan.jobs[i].run == run) use(story.plan.jobs[i], story.outcomes[i]);
}

std::string csvOf(const Table& table) {
  std::ostringstream csv;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) csv << (i > 0 ? "," : "") << csvField(cells[i]);
    csv << "\n";
  };
  line(table.header);
  for (const auto& row : table.rows) line(row);
  return csv.str();
}

Table costsOfJobs(const BatchStory& story) {
  Table table{{"job", "wall_s", "cpu_s", "peak_mb"}, {}};
  for (std::size_t i = 0; i < story.outcomes.size(); ++i) {
    const JobOutcome& o = story.outcomes[i];
    if (o.state == State::open) continue;
    table.rows.push_back(
        {story.plan.jobs[i].name, fixed(o.wall_s, 2), fixed(o.cpu_s, 2), fixed(o.peak_mb, 0)});
  }
  return table;
}

/// Words by how often they are there: "explained 12, none 3".
std::string counted(const std::map<std::string, std::size_t>& words) {
  std::string text;
  for (const auto& [word, count] : words)
    text += (text.empty() ? "" : ", ") + word + " " + std::to_string(count);
  return text;
}

Json toJson(const BatchStory& story) {
  Json json = toJson(story.run);
  json["jobs"] = Json::array();
  for (std::size_t i = 0; i < story.plan.jobs.size(); ++i) {
    const BatchJob& job = story.plan.jobs[i];
    Json row{{"job", job.name},
             {"recording", job.recording.string()},
             {"run", job.run},
             {"seed", job.seed ? Json(*job.seed) : Json()},
             {"state", nameOf(story.outcomes[i].state)},
             {"complaint", story.outcomes[i].complaint}};
    for (const BatchColumn& column : story.plan.columns)
      row["columns"][column.name] = valueOf(story.outcomes[i], column);
    json["jobs"].push_back(row);
  }
  const Table summary = summaryTable(story);
  json["summary"] = {{"columns", summary.header}, {"rows", summary.rows}};
  return json;
}

}  // namespace

std::size_t BatchStory::count(State state) const {
  return static_cast<std::size_t>(
      std::count_if(outcomes.begin(), outcomes.end(), [&](const JobOutcome& o) { return o.state == state; }));
}

Table progressTable(const BatchStory& story) {
  Table table{{"run", "jobs", "done", "failed", "open"}, {}};
  for (const std::string& run : runsOf(story)) {
    std::map<State, std::size_t> counts;
    forEachOf(story, run, [&](const BatchJob&, const JobOutcome& outcome) { ++counts[outcome.state]; });
    table.rows.push_back({run,
                          std::to_string(counts[State::done] + counts[State::failed] + counts[State::open]),
                          std::to_string(counts[State::done]), std::to_string(counts[State::failed]),
                          std::to_string(counts[State::open])});
  }
  return table;
}

Table summaryTable(const BatchStory& story) {
  Table table{{"run", "what", "jobs", "mean", "median", "largest", "values"}, {}};
  for (const std::string& run : runsOf(story))
    for (const BatchColumn& column : story.plan.columns) {
      std::vector<double> numbers;
      std::map<std::string, std::size_t> words;
      std::size_t found = 0;
      forEachOf(story, run, [&](const BatchJob&, const JobOutcome& outcome) {
        const Json value = valueOf(outcome, column);
        found += value.is_null() ? 0 : 1;
        if (value.is_number())
          numbers.push_back(value.get<double>());
        else if (!value.is_null())
          ++words[textOf(value)];
      });
      const ErrorSummary s = summaryOf(numbers);
      table.rows.push_back({run, column.name, std::to_string(found), fixed(s.mean, 4), fixed(s.median, 4),
                            fixed(s.largest, 4), counted(words)});
    }
  return table;
}

Table jobTable(const BatchStory& story) {
  Table table{{"job", "recording", "run", "seed", "state", "complaint"}, {}};
  for (const BatchColumn& column : story.plan.columns) table.header.push_back(column.name);
  for (std::size_t i = 0; i < story.plan.jobs.size(); ++i) {
    const BatchJob& job = story.plan.jobs[i];
    const JobOutcome& outcome = story.outcomes[i];
    table.rows.push_back({job.name, job.recording.string(), job.run,
                          job.seed ? std::to_string(*job.seed) : "", nameOf(outcome.state),
                          outcome.complaint});
    for (const BatchColumn& column : story.plan.columns)
      table.rows.back().push_back(textOf(valueOf(outcome, column)));
  }
  return table;
}

Table costTable(const BatchStory& story) {
  constexpr double kRecordings = 10000, kCores = 64;
  Table table{{"run", "jobs", "processor time a job [s]: mean", "largest", "memory [MB]: largest",
               print("%.0f recordings on %.0f cores [h]", kRecordings, kCores)},
              {}};
  for (const std::string& run : runsOf(story)) {
    std::vector<double> cpu, memory;
    forEachOf(story, run, [&](const BatchJob&, const JobOutcome& outcome) {
      if (outcome.state != State::done) return;
      cpu.push_back(outcome.cpu_s);
      memory.push_back(outcome.peak_mb);
    });
    const ErrorSummary c = summaryOf(cpu), m = summaryOf(memory);
    table.rows.push_back({run, std::to_string(c.count), fixed(c.mean, 2), fixed(c.largest, 2),
                          fixed(m.largest, 0), fixed(c.mean * kRecordings / kCores / 3600, 1)});
  }
  return table;
}

void writeOutputs(const BatchStory& story, const fs::path& folder) {
  writeTextFile(folder / "batch.csv", csvOf(jobTable(story)));
  writeTextFile(folder / "costs.csv", csvOf(costsOfJobs(story)));
  writeJson(folder / "result.json", toJson(story));
  HtmlReport report("A batch of " + std::to_string(story.plan.jobs.size()) + " jobs");
  report.keyValues({{"done", std::to_string(story.count(State::done))},
                    {"failed", std::to_string(story.count(State::failed))},
                    {"open", std::to_string(story.count(State::open))}});
  report.table(progressTable(story));
  if (!story.plan.columns.empty()) report.table(summaryTable(story), "Over the jobs that are done");
  report.heading("What it took");
  report.table(costTable(story), "Of those that are done; each on the machine it ran on");
  report.heading("Each job");
  report.table(jobTable(story));
  report.footer(story.run);
  report.write(folder / "report.html");
}

}  // namespace fathom
