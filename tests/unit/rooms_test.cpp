// The table of rooms in libs/README.md, the CMake files and the #include lines must say the same; and nothing
// includes itself through others.
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/files.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Uses = std::map<std::string, std::set<std::string>>;  // room -> rooms, component -> components

using test::kSource;

/// Rows `| `room` | owns | core, effects |`. "-" is none; "all" is left out of the comparison.
Uses usesInReadme() {
  Uses uses;
  std::istringstream readme(readTextFile(kSource / "libs/README.md"));
  const std::regex row(R"(\| `(\w+)` \|[^|]*\|([^|]*)\|)");
  bool in_table = false;
  for (std::string line; std::getline(readme, line);) {
    if (line.starts_with("| folder | owns | may use |")) in_table = true;
    if (!line.starts_with("|")) in_table = false;
    std::smatch match;
    if (!in_table || !std::regex_match(line, match, row)) continue;
    const std::string text = match[2];
    const std::regex word("\\w+");
    std::set<std::string>& rooms = uses[match[1]];
    for (std::sregex_iterator it(text.begin(), text.end(), word), end; it != end; ++it)
      rooms.insert(it->str());
  }
  return uses;
}

/// The lines of the drawing, from above.
std::vector<std::set<std::string>> drawing() {
  std::vector<std::set<std::string>> lines;
  std::istringstream readme(readTextFile(kSource / "libs/README.md"));
  bool drawn = false;
  for (std::string line; std::getline(readme, line);) {
    if (line.starts_with("Drawn, ")) drawn = true;
    if (!drawn || line.empty()) continue;
    if (line.starts_with("    ")) {
      std::istringstream words(line);
      lines.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
    } else if (!lines.empty()) {
      break;
    }
  }
  return lines;
}

std::vector<fs::path> roomsOnDisk() {
  std::vector<fs::path> rooms;
  for (const auto& entry : fs::directory_iterator(kSource / "libs"))
    if (fs::exists(entry.path() / "CMakeLists.txt")) rooms.push_back(entry.path());
  return rooms;
}

std::set<std::string> usesInCMake(const fs::path& room) {
  const std::string text = readTextFile(room / "CMakeLists.txt");
  const auto call = text.find("fathom_library(" + room.filename().string());
  EXPECT_NE(call, std::string::npos) << room << ": CMakeLists.txt does not call fathom_library for its room";
  std::istringstream words(text.substr(call, text.find(')', call) - call));
  std::set<std::string> uses;
  bool listing = false;
  for (std::string word; words >> word;) {
    if (word == "USES" || word == "PACKAGES" || word == "SOURCES")
      listing = word == "USES";
    else if (listing)
      uses.insert(word);
  }
  return uses;
}

struct Include {
  fs::path file;
  std::string path;  // quoted

  std::string room() const { return path.substr(0, path.find('/')); }
};

std::vector<Include> quotedIncludes(const fs::path& folder) {
  std::vector<Include> includes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    std::istringstream file(readTextFile(entry.path()));
    const std::regex include(R"re(\s*#\s*include\s*"([^"]+)".*)re");
    for (std::string line; std::getline(file, line);) {
      std::smatch match;
      if (std::regex_match(line, match, include)) includes.push_back({entry.path(), match[1]});
    }
  }
  return includes;
}

/// What uses itself through others.
std::set<std::string> inCycles(const Uses& uses) {
  std::set<std::string> cyclic;
  for (const auto& [name, used] : uses) {
    std::set<std::string> reached, open = used;
    while (!open.empty()) {
      const std::string next = *open.begin();
      open.erase(open.begin());
      if (reached.insert(next).second && uses.contains(next))
        open.insert(uses.at(next).begin(), uses.at(next).end());
    }
    if (reached.contains(name)) cyclic.insert(name);
  }
  return cyclic;
}

/// A component is NAME.h with NAME.cpp: which others each one includes.
Uses componentUses(const fs::path& folder) {
  Uses uses;
  for (const Include& include : quotedIncludes(folder)) {
    const std::string component = fs::relative(include.file, folder).replace_extension();
    const std::string used = fs::path(include.path).replace_extension();
    if (used != component) uses[component].insert(used);
  }
  return uses;
}

TEST(Rooms, ReadmeHasTheTable) {
  const Uses uses = usesInReadme();
  EXPECT_TRUE(uses.contains("core") && uses.at("core").empty());
  EXPECT_EQ(uses.at("app"), std::set<std::string>{"all"});
  EXPECT_EQ(uses.at("imaging"), (std::set<std::string>{"core", "effects", "panel", "sensors"}));
}

TEST(Rooms, EveryRoomIsInTheTable) {
  const Uses uses = usesInReadme();
  for (const auto& room : roomsOnDisk()) EXPECT_TRUE(uses.contains(room.filename())) << room;
}

TEST(Rooms, CMakeSaysWhatTheTableSays) {
  const Uses uses = usesInReadme();
  for (const auto& room : roomsOnDisk()) {
    if (!uses.contains(room.filename())) continue;
    EXPECT_EQ(usesInCMake(room), uses.at(room.filename())) << room;
  }
}

TEST(Rooms, IncludesKeepToTheTable) {
  const Uses uses = usesInReadme();
  for (const auto& room : roomsOnDisk()) {
    if (!uses.contains(room.filename())) continue;
    for (const auto& include : quotedIncludes(room))
      EXPECT_TRUE(include.room() == room.filename() || uses.at(room.filename()).contains(include.room()))
          << include.file << " includes \"" << include.path << "\"";
  }
}

TEST(Rooms, DrawingIsTheTables) {
  const Uses uses = usesInReadme();
  std::set<std::string> above;
  for (const std::set<std::string>& line : drawing()) {
    for (const std::string& room : line) {
      ASSERT_TRUE(uses.contains(room)) << room << " is drawn, but not in the table";
      for (const std::string& used : uses.at(room))
        EXPECT_TRUE(used == "all" || above.contains(used)) << room << " is drawn above or beside " << used;
    }
    above.insert(line.begin(), line.end());
  }
  for (const auto& [room, used] : uses) EXPECT_TRUE(above.contains(room)) << room << " is not drawn";
}

TEST(Rooms, NoRoomUsesItselfThroughOthers) { EXPECT_EQ(inCycles(usesInReadme()), std::set<std::string>{}); }

TEST(Rooms, NoComponentIncludesItselfThroughOthers) {
  const Uses libs = componentUses(kSource / "libs"), app = componentUses(kSource / "app");
  EXPECT_TRUE(libs.at("core/yaml").contains("core/error")) << "components are not found";
  EXPECT_EQ(inCycles(libs), std::set<std::string>{});
  EXPECT_EQ(inCycles(app), std::set<std::string>{});
}

// Each with its source: constants.h. Places of columns are no numbers that anything is decided by.
TEST(Rooms, WhatTheDiagnosisDecidesByIsInOneFile) {
  const std::regex number(R"(constexpr (double|float|int|std::size_t)\s+k\w+\s*=\s*-?[0-9])");
  ASSERT_TRUE(std::regex_search(readTextFile(kSource / "libs/diagnosis/constants.h"), number));
  for (const auto& file : fs::directory_iterator(kSource / "libs/diagnosis"))
    if (file.path().extension() == ".cpp") {
      EXPECT_FALSE(std::regex_search(readTextFile(file.path()), number)) << file.path().filename();
    }
}

}  // namespace
}  // namespace fathom
