// Every header of the libraries can be included alone: whoever does needs to know nothing else.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/for_each.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

const fs::path kLibs = test::kSource / "libs";

/// A header below libs/, and what it includes, by way of others of ours too.
struct Header {
  std::string text;
  std::set<std::string> ours, others;
};

/// By their paths below libs/.
const std::map<std::string, Header>& headers() {
  static const std::map<std::string, Header> all = [] {
    std::map<std::string, Header> direct;
    const std::regex include(R"re(#include (["<])([^">]+)[">].*)re");
    for (const auto& entry : fs::recursive_directory_iterator(kLibs)) {
      if (entry.path().extension() != ".h") continue;
      Header& header = direct[fs::relative(entry.path(), kLibs).string()];
      header.text = readTextFile(entry.path());
      std::istringstream lines(header.text);
      std::smatch match;
      for (std::string line; std::getline(lines, line);)
        if (std::regex_match(line, match, include))
          (match[1] == "<" ? header.others : header.ours).insert(match[2]);
    }
    // As often as the longest chain of them is long.
    for (bool grew = true; grew;) {
      grew = false;
      for (auto& [name, header] : direct)
        for (const std::string& included : std::set<std::string>(header.ours)) {
          const auto found = direct.find(included);
          if (found == direct.end()) continue;  // made by the build
          const std::size_t before = header.ours.size() + header.others.size();
          header.ours.insert(found->second.ours.begin(), found->second.ours.end());
          header.others.insert(found->second.others.begin(), found->second.others.end());
          grew = grew || header.ours.size() + header.others.size() > before;
        }
    }
    return direct;
  }();
  return all;
}

/// Without comments and texts.
std::string codeOf(const std::string& text) {
  return std::regex_replace(text, std::regex(R"re(//[^\n]*|"(\\.|[^"\\\n])*")re"), " ");
}

/// Types and constants that one header of ours alone declares, outside of any class: name -> header.
std::map<std::string, std::string> declaredOnce() {
  const std::regex declared(
      R"re((?:^|\n)(?:template [^\n]*\n)?(?:inline |constexpr |extern |static )*(?:(?:struct|class|enum class|enum) ([A-Z]\w*)(?=[^;]*\{)|using ([A-Z]\w*) =|const(?:expr)? [^=;\n]*\b(k[A-Z]\w*)))re");
  std::map<std::string, std::set<std::string>> by_name;
  for (const auto& [name, header] : headers()) {
    const std::string code = codeOf(header.text);
    for (std::sregex_iterator at(code.begin(), code.end(), declared), end; at != end; ++at)
      for (int group = 1; group <= 3; ++group)
        if ((*at)[group].matched) by_name[(*at)[group]].insert(name);
  }
  std::map<std::string, std::string> once;
  for (const auto& [name, where] : by_name)
    if (where.size() == 1) once[name] = *where.begin();
  return once;
}

/// In a header or in what it includes, inside of a class too.
bool isDeclaredIn(const std::string& header, const std::string& name) {
  const std::regex declaration("\\b(?:struct|class|enum|using) " + name + "\\b");
  std::set<std::string> seen = headers().at(header).ours;
  seen.insert(header);
  return std::any_of(seen.begin(), seen.end(), [&](const std::string& one) {
    const auto found = headers().find(one);
    return found != headers().end() && std::regex_search(codeOf(found->second.text), declaration);
  });
}

TEST(Headers, IncludeWhatTheyNameOfOurs) {
  const auto declared = declaredOnce();
  EXPECT_GT(declared.size(), headers().size()) << "the search for declarations finds too little";
  // What is of a class, or another library's, is behind two colons, or declared in what is included.
  const std::regex word("(?:::)?\\b(?:[A-Z]|k[A-Z])\\w*");
  std::size_t named = 0;
  for (const auto& [name, header] : headers()) {
    const std::string code = codeOf(header.text);
    std::set<std::string> missing;
    for (std::sregex_iterator at(code.begin(), code.end(), word), end; at != end; ++at) {
      const auto found = declared.find(at->str());
      if (found == declared.end() || found->second == name) continue;
      ++named;
      if (!header.ours.contains(found->second) && !isDeclaredIn(name, at->str()))
        missing.insert(at->str() + " of " + found->second);
    }
    for (const std::string& one : missing) ADD_FAILURE() << name << " names " << one;
  }
  EXPECT_GT(named, 1000U);
}

/// What a name is declared by: one of these includes (beginnings count, for Eigen and OpenCV).
const std::map<std::string, std::vector<std::string>> kDeclaredBy{
    {"std::array", {"array"}},
    {"std::bitset", {"bitset"}},
    {"std::deque", {"deque"}},
    {"std::filesystem", {"filesystem"}},
    {"std::function", {"functional"}},
    {"std::map", {"map"}},
    {"std::mutex", {"mutex"}},
    {"std::optional", {"optional"}},
    {"std::set", {"set"}},
    {"std::shared_ptr", {"memory"}},
    {"std::span", {"span"}},
    {"std::string", {"string"}},
    {"std::string_view", {"string_view", "string"}},
    {"std::tuple", {"tuple"}},
    {"std::unique_ptr", {"memory"}},
    {"std::variant", {"variant"}},
    {"std::vector", {"vector"}},
    {"std::sqrt", {"cmath"}},
    {"std::uint64_t", {"cstdint"}},
    {"std::size_t", {"cstddef", "array", "string", "vector", "tuple", "cstdint", "Eigen/"}},
    {"Eigen::", {"Eigen/", "ceres/"}},
    {"ceres::", {"ceres/"}},
    {"cv::", {"opencv2/"}},
    {"nlohmann::", {"nlohmann/"}},
    {"mrpt::", {"mrpt/"}}};

/// Whether one of `includes` is among what a header includes.
bool includesOne(const Header& header, const std::vector<std::string>& includes) {
  for (const std::string& other : header.others)
    for (const std::string& begin : includes)
      if (begin.ends_with('/') ? other.starts_with(begin) : other == begin) return true;
  return false;
}

TEST(Headers, IncludeWhatTheyNameOfOthers) {
  for (const auto& [name, header] : headers()) {
    const std::string code = codeOf(header.text);
    for (const auto& [declared, includes] : kDeclaredBy)
      if (std::regex_search(code, std::regex("\\b" + declared + (declared.ends_with(':') ? "" : "\\b"))))
        EXPECT_TRUE(includesOne(header, includes)) << name << " names " << declared;
  }
}

/// Parses with what all of them together include of others' read once: Eigen alone takes longer than all of
/// ours.
std::map<std::string, std::string> complaintsOf(const fs::path& folder) {
  std::set<std::string> others;
  for (const auto& [name, header] : headers()) others.insert(header.others.begin(), header.others.end());
  std::string all;
  for (const std::string& other : others) all += "#include <" + other + ">\n";
  writeTextFile(folder / "others.h", all);
  const std::string compiler =
      FATHOM_COMPILER " -std=c++20 -x c++-header -Wno-pragma-once-outside-header " FATHOM_INCLUDES " ";
  std::string with_others;
  if (std::string(FATHOM_COMPILER).find("clang") != std::string::npos) {
    const std::string kept = test::shellQuoted((folder / "others.pch").string());
    const auto parsed =
        test::runShell(compiler + test::shellQuoted((folder / "others.h").string()) + " -o " + kept);
    EXPECT_EQ(parsed.status, 0) << parsed.err;
    with_others = "-include-pch " + kept + " ";
  }
  std::vector<std::string> names;
  for (const auto& [name, header] : headers()) names.push_back(name);
  std::vector<std::string> complaints(names.size());
  forEachIndex(names.size(), "compiling headers", [&](std::size_t i) {
    const auto result = test::runShell(compiler + with_others + "-fsyntax-only " +
                                       test::shellQuoted((kLibs / names[i]).string()));
    if (result.status != 0) complaints[i] = result.err.empty() ? "the compiler fails" : result.err;
  });
  std::map<std::string, std::string> found;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!complaints[i].empty()) found[names[i]] = complaints[i];
  return found;
}

TEST(Headers, EachCompilesAlone) {
  if (std::getenv("FATHOM_THOROUGH") == nullptr)
    GTEST_SKIP() << "takes ten minutes of processor time: run-tests --thorough has it done";
  for (const auto& [name, complaint] : complaintsOf(test::scratchFolder()))
    ADD_FAILURE() << name << "\n" << complaint;
}

}  // namespace
}  // namespace fathom
