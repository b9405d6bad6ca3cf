#include "proof_report.h"

#include <cmath>
#include <map>
#include <set>

#include "core/progress.h"
#include "core/text.h"
#include "proof_measures.h"
#include "real_recordings.h"

namespace fathom::proof {
namespace {

std::string secondsOff(const std::optional<double>& off_s) { return off_s ? fixed(*off_s, 2) : "-"; }

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text.append(text.empty() ? "" : " + ").append(part);
  return text;
}

std::string answerOf(const Scored& s) {
  if (!s.failure.empty()) return s.failure;
  return s.stated.empty() ? nameOf(s.outcome) : joined(s.stated);
}

std::string hiddenIn(const Scored& s) {
  std::vector<std::string> names;
  for (const ProofCase::Effect& effect : s.proof_case.effects) names.push_back(effect.name);
  for (const auto& outside : s.proof_case.generator.at("outside"))
    names.push_back(outside.at("kind").get<std::string>() + print(" %g", outside.at("size").get<double>()));
  return names.empty() ? "nothing" : joined(names);
}

}  // namespace

Table effectTable(const std::vector<Scored>& all) {
  std::set<double> strata;
  std::map<std::string, std::map<double, std::vector<std::string>>> rows;
  for (const Scored& s : all)
    if (isEffect(s)) {
      strata.insert(s.proof_case.stratum);
      const bool one_of_many = s.outcome == Outcome::right_set || s.outcome == Outcome::needless_set;
      rows[s.proof_case.effects[0].id][s.proof_case.stratum].push_back(
          nameOf(s.outcome) + (one_of_many ? print(" of %.0f", s.set_size) : ""));
    }
  Table table{{"effect"}, {}};
  for (const double stratum : strata) table.header.push_back(print("sqrt lambda %g", stratum));
  for (const auto& [id, by_stratum] : rows) {
    table.rows.push_back({id});
    for (const double stratum : strata) {
      const auto found = by_stratum.find(stratum);
      table.rows.back().push_back(found == by_stratum.end() ? "" : joined(found->second));
    }
  }
  return table;
}

Table intervalTable(const std::vector<Scored>& all) {
  Table table{{"effect", "sqrt lambda", "answer", "onset off [s]", "end off [s]"}, {}};
  for (const Scored& s : all)
    if (s.proof_case.kind == ProofCase::Kind::interval)
      table.rows.push_back({hiddenIn(s), fixed(s.proof_case.stratum, 0), answerOf(s),
                            secondsOff(s.onset_off_s), secondsOff(s.end_off_s)});
  return table;
}

Table decoyTable(const std::vector<Scored>& all) {
  Table table{{"recording", "hidden", "tempting", "lambda (1 - c)", "right would be", "answer"}, {}};
  for (const Scored& s : all) {
    if (!isDecoy(s)) continue;
    const ProofCase::Effect& hidden = s.proof_case.effects[0];
    table.rows.push_back({s.proof_case.name, hidden.name, hidden.runner_up, fixed(hidden.nearest, 1),
                          needsSet(s) ? "both" : "the hidden one", answerOf(s)});
  }
  return table;
}

Table advisedTable(const std::vector<Scored>& all) {
  Table table{{"recording", "hidden", "answer", "advised", "answer then"}, {}};
  for (const Scored& s : all) {
    if (!s.advised) continue;
    const Advised& advised = *s.advised;
    const char* outcome = nameOf(advised.outcome);
    table.rows.push_back({s.proof_case.name, hiddenIn(s), answerOf(s), advised.manoeuvre,
                          !advised.failure.empty() ? advised.failure
                          : advised.stated.empty() ? outcome
                                                   : joined(advised.stated)});
  }
  return table;
}

Table namesTable(const std::vector<Scored>& all) {
  std::map<std::string, std::map<std::string, int>> counts;
  for (const Scored& s : all)
    if (isAlone(s) || isDecoy(s)) ++counts[s.proof_case.effects[0].id][s.first_right ? "right" : answerOf(s)];
  Table table{{"hidden", "recordings", "named first", "taken for"}, {}};
  for (const auto& [id, answers] : counts) {
    int total = 0, right = 0;
    std::string others;
    for (const auto& [answer, count] : answers) {
      total += count;
      if (answer == "right")
        right = count;
      else
        others += (others.empty() ? "" : "; ") + print("%d ", count) + answer;
    }
    table.rows.push_back({id, std::to_string(total), std::to_string(right), others});
  }
  return table;
}

Table confusionTable(const std::vector<Scored>& all) {
  Table table{{"recording", "hidden", "size [sqrt lambda]", "answer"}, {}};
  for (const Scored& s : all) {
    const bool good = isNull(s)      ? s.outcome == Outcome::none
                      : isOutside(s) ? s.outcome == Outcome::unexplained
                                     : isRight(s);
    if (good) continue;
    const double size = isOutside(s) ? std::sqrt(s.proof_case.lambda) : s.proof_case.stratum;
    table.rows.push_back({s.proof_case.name, hiddenIn(s), isNull(s) ? "" : fixed(size, 1), answerOf(s)});
  }
  return table;
}

std::vector<Table> tablesOf(const ProofResults& results) {
  const std::vector<Scored>& all = results.scored;
  std::vector<Table> tables;
  for (const Table& table :
       {measureTable(all), effectTable(all), intervalTable(all), decoyTable(all), advisedTable(all),
        namesTable(all), confusionTable(all), realTable(results.real)})
    if (!table.rows.empty()) tables.push_back(table);
  return tables;
}

void writeProofReport(const ProofResults& results, const RunInfo& run, const std::filesystem::path& file) {
  const std::vector<Scored>& all = results.scored;
  HtmlReport report("Proof on sealed recordings");
  report.paragraph(
      "Recordings by a generator that shares no physics with the program, diagnosed in a sandbox without the "
      "truth, then scored.");
  report.table(measureTable(all), "What was asked and what was reached; in brackets 95 % intervals.");
  Series found{.name = "truth in the stated set", .style = Series::Style::kPoints};
  for (const auto& [stratum, counts] : foundByStratum(all)) {
    found.x.push_back(std::log2(stratum));
    found.y.push_back(100 * counts.first / counts.second);
  }
  if (!interrupted())  // a plot would not be drawn any more, and what is done is to be reported
    report.plot({.title = "Effects found, by size",
                 .x_label = "log2 of sqrt lambda",
                 .y_label = "found [%]",
                 .series = {found, fisherLimit()},
                 .y_range = {{0, 100}}});
  const auto section = [&](const char* title, const Table& table, const char* caption = "") {
    if (table.rows.empty()) return;
    report.heading(title);
    report.table(table, caption);
  };
  section("Effects by size", effectTable(all));
  section("On for a part of the recording", intervalTable(all));
  section("Decoys", decoyTable(all), "Effects on dives on which another one, which is absent, is tempting.");
  section("Sets, and what the advised manoeuvre makes of them", advisedTable(all));
  section("Effects, and what they were taken for", namesTable(all));
  section("What was not right", confusionTable(all));
  section("Real recordings", realTable(results.real),
          "What they hide nobody knows for sure, so that nothing is right or wrong.");
  report.footer(run);
  report.write(file);
}

}  // namespace fathom::proof
