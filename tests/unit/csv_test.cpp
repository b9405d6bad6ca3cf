#include "recording/csv.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <fstream>

#include "core/error.h"
#include "core/files.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

std::vector<std::vector<double>> readText(const std::string& text) {
  const auto file = test::scratchFolder() / "table.csv";
  writeTextFile(file, text);
  return readCsv(file, {"t", "x", "y"});
}

void expectError(const std::string& text, const std::string& where, const std::string& why) {
  try {
    readText(text);
    ADD_FAILURE() << "accepted: " << text;
  } catch (const Error& e) {
    EXPECT_EQ(e.where, where) << text;
    EXPECT_NE(e.why.find(why), std::string::npos) << e.what();
    EXPECT_NE(e.file.find("table.csv"), std::string::npos);
  }
}

TEST(Csv, ReadsColumnsInTheOrderAskedFor) {
  const std::vector<std::vector<double>> expected{{0, 2, 1}, {0.5, -4e-3, 3}};
  EXPECT_EQ(readText("t,y,x\n0,1,2\n0.5,3,-4e-3\n"), expected);
  EXPECT_EQ(readText("t,y,x\r\n0,1,2\r\n0.5,3,-4e-3"), expected) << "DOS lines, no end of line at the end";
}

TEST(Csv, RefusesWhatIsNotTheTable) {
  expectError("", "line 1", "empty");
  expectError("t,x\n0,1\n", "line 1", "column `y` is missing");
  expectError("t,x,y,z\n0,1,2,3\n", "line 1", "unknown column `z`");
  expectError("t,x,y,x\n0,1,2,3\n", "line 1", "column `x` twice");
  expectError("t,x,y\n", "line 2", "no rows");
  expectError("t,x,y\n0,1,2\n1,2\n", "line 3", "2 fields instead of 3");
  expectError("t,x,y\n0,1,2\n1,2,3,4\n", "line 3", "4 fields instead of 3");
  expectError("t,x,y\n0,1,2\n\n", "line 3", "1 fields instead of 3");
  expectError("t,x,y\n0,1,two\n", "line 2", "not a finite number: `two`");
  expectError("t,x,y\n0,1,2m\n", "line 2", "not a finite number: `2m`");
  expectError("t,x,y\n0,1, 2\n", "line 2", "not a finite number");
  expectError("t,x,y\n0,1,\n", "line 2", "not a finite number: ``");
  expectError("t,x,y\n0,1,nan\n", "line 2", "not a finite number");
  expectError("t,x,y\n0,inf,1\n", "line 2", "not a finite number");
  expectError("t,x,y\n0,1,1e999\n", "line 2", "not a finite number");
  expectError("t,x,y\n1,1,2\n1,1,2\n", "line 3", "time does not increase");
  expectError("t,x,y\n1,1,2\n0,1,2\n", "line 3", "time does not increase");
  expectError("t,x,y\n0,1," + std::string(5000, '1') + "\n", "line 2", "longer than 4096");
}

TEST(Csv, ReadsGzipAndSaysWhereItIsCutOff) {
  const auto folder = test::scratchFolder();
  std::string text = "t,x,y\n";
  for (int k = 0; k < 5000; ++k) text += std::to_string(k) + "," + std::to_string(k * k % 977) + ",3\n";
  const gzFile gz = gzopen((folder / "a.csv.gz").c_str(), "wb");
  gzwrite(gz, text.data(), static_cast<unsigned>(text.size()));
  gzclose(gz);
  EXPECT_EQ(readCsv(folder / "a.csv.gz", {"t", "x", "y"}).size(), 5000U);

  const std::string whole = readTextFile(folder / "a.csv.gz");
  for (const std::size_t keep : {whole.size() - 1, whole.size() / 2, std::size_t{12}}) {
    writeTextFile(folder / "cut.csv.gz", whole.substr(0, keep));
    EXPECT_THROW(readCsv(folder / "cut.csv.gz", {"t", "x", "y"}), Error) << keep << " bytes";
  }
}

TEST(Csv, LinesNeedNoHeader) {
  const auto file = test::scratchFolder() / "lines.csv";
  const auto complaint = [&] {
    try {
      readLines(file);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  writeTextFile(file, "1, 2\r\nx,\n");
  EXPECT_EQ(readLines(file), (std::vector<std::vector<std::string>>{{"1", " 2"}, {"x", ""}}));
  writeTextFile(file, "1,2\n3\n");
  EXPECT_NE(complaint().find("line 2: has 1 fields instead of 2"), std::string::npos) << complaint();
  writeTextFile(file, "");
  EXPECT_NE(complaint().find("line 1: the file is empty"), std::string::npos) << complaint();
}

TEST(Csv, RefusesMissingFileAndFolder) {
  const auto folder = test::scratchFolder();
  EXPECT_THROW(readCsv(folder / "none.csv", {"t"}), Error);
  EXPECT_THROW(readCsv(folder, {"t"}), Error);
}

}  // namespace
}  // namespace fathom
