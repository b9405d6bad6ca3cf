// The sealed generator's case files, its recordings, and that it shares no physics with the program.
#include "sealed/sealed_case.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "recording/rawlog.h"
#include "sealed/recording.h"
#include "sealed/sha256.h"
#include "support/sealed_example.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom::sealed {
namespace {
namespace fs = std::filesystem;

std::string complaint(const std::string& text) {
  try {
    parseSealedCase(text, "case.json");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& old_part, const std::string& new_part) {
  return text.replace(text.find(old_part), old_part.size(), new_part);
}

TEST(SealedCase, SaysWhatIsWrongAndWhere) {
  const std::string good = exampleCaseText();
  EXPECT_EQ(complaint(good), "");
  EXPECT_EQ(complaint(replaced(good, "\"noise\"", "\"nose\"")), "case.json: noise: is missing");
  EXPECT_EQ(complaint(replaced(good, "\"rich\": false", "\"rich\": false, \"x\": 1")),
            "case.json: x: unknown key");
  EXPECT_EQ(complaint(replaced(good, "\"rich\": false", "\"rich\": false, \"rich\": true")),
            "case.json: rich: is there twice");
  EXPECT_EQ(complaint(replaced(good, "\"seed\": 17", "\"seed\": -1")),
            "case.json: seed: must be a whole number, not negative");
  EXPECT_EQ(complaint(exampleCaseText(R"([{"id": "dvl-scale", "parameters": {"scale": 1}}])")),
            "case.json: effects[0].parameters.scale_error: is missing");
  EXPECT_EQ(complaint(exampleCaseText(R"([{"id": "dvl-scale", "parameters": {"scale_error": [1, 2]}}])")),
            "case.json: effects[0].parameters.scale_error: must be a number");
  EXPECT_EQ(complaint(exampleCaseText(R"([{"id": "vignetting", "parameters": {"corner_loss": 0.2}}])")),
            "case.json: effects[0].id: changes light only: needs camera `images`");
  EXPECT_NE(
      complaint(exampleCaseText(R"([{"id": "dvl-scales", "parameters": {}}])")).find("unknown: `dvl-scales`"),
      std::string::npos);
  EXPECT_NE(complaint(exampleCaseText("[]", "corners", R"([{"kind": "ghost", "size": 1}])"))
                .find("unknown: `ghost`"),
            std::string::npos);
  EXPECT_EQ(complaint(replaced(good, "\"rich\", \"seed\"", "\"given\", \"seed\"")),
            "case.json: dive.path: is missing");
  EXPECT_EQ(complaint(replaced(good, "\"rich\", \"seed\"", "\"rich\", \"path\": \"a.tum\", \"seed\"")),
            "case.json: dive.path: unknown key");
  EXPECT_NE(complaint("{\"name\": ").find("is no JSON"), std::string::npos);
}

TEST(SealedCase, AGivenPathStandsBesideTheCase) {
  const std::string given =
      replaced(exampleCaseText(), "\"rich\", \"seed\"", "\"given\", \"path\": \"path.tum\", \"seed\"");
  EXPECT_EQ(parseSealedCase(given, "folder/case.json").dive.path, fs::path("folder/path.tum"));
}

TEST(Sha256, KnownAnswers) {  // FIPS 180-2, appendix B
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

/// All files below a folder: path to contents.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(folder).generic_string()] = readTextFile(entry.path());
  return files;
}

class SealedRecording : public testing::Test {
 protected:
  void TearDown() override { fs::remove_all(folder_); }
  fs::path seal(const std::string& name, const std::string& text) const {
    sealRecording(parseSealedCase(text, "case.json"), folder_ / name, folder_ / (name + "_truth"));
    return folder_ / name;
  }
  const fs::path folder_ = test::scratchFolder();
};

const std::string kNoisyCase =
    replaced(exampleCaseText(
                 R"([{"id": "marker-moved", "parameters": {"marker_id": 420, "offset_m": [0.01, 0, 0]}}])"),
             "\"noise\": false", "\"noise\": true");

TEST_F(SealedRecording, TheSameCaseGivesTheSameBytes) {
  EXPECT_EQ(contents(seal("one", kNoisyCase)), contents(seal("other", kNoisyCase)));
}

TEST_F(SealedRecording, HoldsWhatAUserHasAndNothingElse) {
  const auto files = contents(seal("dive", kNoisyCase));
  std::string names;
  for (const auto& [name, bytes] : files) {
    names += name + " ";
    EXPECT_EQ(bytes.find("example"), std::string::npos) << name;
  }
  EXPECT_EQ(names, "panel.mtl panel.obj panel.yaml recording.rawlog recording_corners.csv vehicle.yaml ");
  RawlogReader reader(folder_ / "dive/recording.rawlog");
  EXPECT_EQ(reader.header().panel_map, "panel.yaml");
  EXPECT_EQ(reader.header().vehicle, "vehicle.yaml");
  EXPECT_EQ(reader.header().description, "");
  while (const auto sample = reader.next()) EXPECT_NE(sample->label, labels::kTruth);
}

TEST_F(SealedRecording, IsSealed) {
  const auto files = contents(seal("dive", kNoisyCase));
  const auto truth = nlohmann::json::parse(readTextFile(folder_ / "dive_truth/truth.json"));
  EXPECT_EQ(truth.at("sha256").size(), files.size());
  for (const auto& [name, bytes] : files) EXPECT_EQ(truth.at("sha256").at(name), sha256(bytes)) << name;
  EXPECT_EQ(truth.at("case").at("name"), "example");
}

TEST_F(SealedRecording, LeavesWhatIsThere) {
  seal("dive", kNoisyCase);
  EXPECT_THROW(seal("dive", kNoisyCase), Error);
}

TEST_F(SealedRecording, RefusesAMarkerThatIsNotThere) {
  EXPECT_THROW(seal("dive", replaced(kNoisyCase, "420", "421")), Error);
  EXPECT_FALSE(fs::exists(folder_ / "dive"));
}

// ---- separation

const std::set<std::string> kAllowedRooms{"core", "panel", "recording"};

TEST(SealedSeparation, IncludesOnlyAllowedRooms) {
  const std::regex include(R"re(\s*#\s*include\s*"([^"/]+)/[^"]*".*)re");
  int looked_at = 0;
  for (const auto& entry : fs::directory_iterator(test::kSource / "tests/sealed")) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    ++looked_at;
    std::istringstream file(readTextFile(entry.path()));
    std::smatch match;
    for (std::string line; std::getline(file, line);)
      if (std::regex_match(line, match, include))
        EXPECT_TRUE(kAllowedRooms.contains(match[1])) << entry.path() << ": " << line;
  }
  EXPECT_GT(looked_at, 20);
}

TEST(SealedSeparation, LinksOnlyAllowedRooms) {
  const std::string map = readTextFile(fs::path(FATHOM_BINARY_DIR) / "tests/sealed/fathom-seal.map");
  // What is taken of an archive, not that it is looked into: recordings' entries are types of sensors'
  // headers, of which no code is taken.
  const std::regex archive(R"(libfathom_(\w+)\.a\()");
  std::set<std::string> linked;
  for (std::sregex_iterator it(map.begin(), map.end(), archive), end; it != end; ++it)
    linked.insert((*it)[1]);
  EXPECT_EQ(linked, kAllowedRooms);
}

}  // namespace
}  // namespace fathom::sealed
