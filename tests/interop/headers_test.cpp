// Every header of the libraries compiles alone: whoever includes it needs to know nothing else.
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include "core/for_each.h"
#include "support/run_program.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

const fs::path kLibs = test::kSource / "libs";

/// Of the headers below libs/, by their paths there: which others each includes, by way of others too.
class IncludeGraph {
 public:
  IncludeGraph() {
    for (const auto& entry : fs::recursive_directory_iterator(kLibs))
      if (entry.path().extension() == ".h") read(entry.path());
    for (const auto& [header, included] : direct_) close(header);
  }
  /// Each after those that it includes.
  const std::vector<std::string>& headers() const { return ordered_; }
  const std::set<std::string>& included(const std::string& header) const { return all_.at(header); }
  std::size_t includers(const std::string& header) const {
    std::size_t count = 0;
    for (const auto& [other, included] : direct_) count += included.count(header);
    return count;
  }

 private:
  void read(const fs::path& file) {
    std::set<std::string>& included = direct_[fs::relative(file, kLibs).string()];
    std::istringstream text(readTextFile(file));
    const std::regex include(R"re(#include "([^"]+)".*)re");
    std::smatch match;
    for (std::string line; std::getline(text, line);)
      if (std::regex_match(line, match, include) && fs::exists(kLibs / match[1].str()))
        included.insert(match[1]);
  }
  void close(const std::string& header) {
    if (all_.contains(header)) return;
    std::set<std::string>& all = all_[header];
    for (const std::string& included : direct_.at(header)) {
      close(included);
      all.insert(included);
      all.insert(all_.at(included).begin(), all_.at(included).end());
    }
    ordered_.push_back(header);
  }

  std::map<std::string, std::set<std::string>> direct_, all_;
  std::vector<std::string> ordered_;
};

/// Parsed headers are kept and taken from there by those that include them: a header that compiles alone
/// makes no difference to what follows it, and Eigen is read once instead of two hundred times.
class HeaderCompiler {
 public:
  HeaderCompiler(const IncludeGraph& graph, fs::path folder) : graph_(graph), folder_(std::move(folder)) {}

  void keep(const std::string& header) {
    const std::string file = (folder_ / (std::to_string(kept_.size()) + ".pch")).string();
    const auto result = test::runShell(command(header) + " -o " + test::shellQuoted(file));
    if (result.status == 0) kept_[header] = file;
  }
  /// What the compiler complains of; empty: nothing.
  std::string complaint(const std::string& header) const {
    auto result = test::runShell(command(header) + " -fsyntax-only");
    // With what is kept, clang 14 itself may crash; by itself a header is the judge.
    if (result.status != 0) result = test::runShell(command(header, false) + " -fsyntax-only");
    return result.status == 0 ? "" : result.err;
  }

 private:
  std::string command(const std::string& header, bool with_kept = true) const {
    std::string line =
        FATHOM_COMPILER " -std=c++20 -x c++-header -Wno-pragma-once-outside-header " FATHOM_INCLUDES;
    std::optional<std::string> largest;
    for (const auto& [kept, file] : kept_)
      if (graph_.included(header).contains(kept) &&
          (!largest || graph_.included(kept).size() > graph_.included(*largest).size()))
        largest = kept;
    if (largest && with_kept) line += " -include-pch " + kept_.at(*largest);
    return line + " " + test::shellQuoted((kLibs / header).string());
  }

  const IncludeGraph& graph_;
  fs::path folder_;
  std::map<std::string, std::string> kept_;  // header -> its parsed form
};

TEST(Headers, EachCompilesAlone) {
  if (test::kSanitized) GTEST_SKIP() << "the same headers as without sanitizers";
  const IncludeGraph graph;
  HeaderCompiler compiler(graph, test::scratchFolder());
  if (std::string(FATHOM_COMPILER).find("clang") != std::string::npos)
    for (const std::string& header : graph.headers())
      if (graph.includers(header) >= 8) compiler.keep(header);
  const std::vector<std::string>& headers = graph.headers();
  std::vector<std::string> complaints(headers.size());
  forEachIndex(headers.size(), "compiling headers",
               [&](std::size_t i) { complaints[i] = compiler.complaint(headers[i]); });
  for (std::size_t i = 0; i < headers.size(); ++i) EXPECT_EQ(complaints[i], "") << headers[i];
}

}  // namespace
}  // namespace fathom
