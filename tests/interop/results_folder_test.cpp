// What a command leaves in its folder when that cannot be written, is written by two at once, or when its
// inputs point elsewhere. Every command is run on paths with blanks and letters that ASCII lacks.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "panel/panel_maps.h"
#include "recording/rawlog.h"
#include "simulation/copy_panel_map.h"
#include "support/every_command.h"
#include "support/folder_contents.h"
#include "support/panels.h"
#include "support/shared_data.h"
#include "support/sil_recordings.h"

namespace fathom::test {
namespace {
namespace fs = std::filesystem;

std::string nameOfCommand(const testing::TestParamInfo<WritingCommand>& info) { return info.param.name; }

/// Earlier results are as they were, and nothing else is there.
void expectUnchanged(const fs::path& folder, const std::map<std::string, std::string>& before) {
  const auto after = contentsOf(folder);
  EXPECT_TRUE(after == before) << "before: " << namesIn(before) << "\nafter: " << namesIn(after);
}

void expectOneLine(const ProgramResult& result) {
  EXPECT_EQ(result.status, 2) << result.out << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_TRUE(result.err.starts_with("fathom: ")) << result.err;
}

// ---- every command

class AnyPath : public testing::TestWithParam<WritingCommand> {};

TEST_P(AnyPath, IsReadAndWritten) {
  inputFolder();
  const fs::path results = scratchFolder() / "Ergebnisse – 1";
  const auto result = run(GetParam(), results);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const auto files = contentsOf(results);
  EXPECT_FALSE(files.empty());
  for (const auto& [name, bytes] : files) {
    EXPECT_FALSE(name.ends_with(".part")) << name;
    EXPECT_TRUE(!bytes.empty() || name.ends_with("lock")) << name;
  }
}
INSTANTIATE_TEST_SUITE_P(Of, AnyPath, testing::ValuesIn(writingCommands()), nameOfCommand);

// Commands that only print.
TEST(AnyPathToRead, IsReadAndSaid) {
  const auto in = [](const std::string& name) { return shellQuoted((inputFolder() / name).string()); };
  const std::string image = in("Fahrt ü 1_Images/CAMERA_0001.png");
  for (const auto& [arguments, part] :
       {std::pair("info " + in("Fahrt ü 1.rawlog"), "Fahrt ü 1_vehicle.yaml"),
        {"info " + in("Fahrt ü 1.rawlog") + " --vehicle " + in("Fahrzeug ö.yaml"), "Fahrzeug ö.yaml"},
        {"map check " + in("panel übersicht.yaml"), "panel übersicht.yaml"},
        {"fsim " + image + " " + image, "1.0"}}) {
    const auto result = runFathom(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find(part), std::string::npos) << result.out;
  }
  expectBadInput(runFathom("info " + in("fehlt ü.rawlog")), "fehlt ü.rawlog");
}

// ---- folders that cannot be written

/// Those that take a second or two: a run that fails at the end takes as long as one that does not.
std::vector<WritingCommand> quickCommands() {
  std::vector<WritingCommand> commands;
  for (const char* name : {"simulate", "localize", "tasks", "smooth", "sil", "detect", "map", "importbag",
                           "importcsv", "importcorners", "importtiepoints", "importvideo", "importcamera",
                           "exportcsv", "exporttum", "exportkml", "exportcolmap", "man"})
    commands.push_back(writingCommand(name));
  return commands;
}

class Unwritable : public testing::TestWithParam<WritingCommand> {
 protected:
  /// Earlier results, of the same command.
  void SetUp() override {
    if (runShell("bwrap --dev-bind / / true").status != 0)
      GTEST_SKIP() << "no sandbox (bubblewrap) can be made here";
    inputFolder();
    ASSERT_EQ(run(GetParam(), results_).status, 0);
    before_ = contentsOf(results_);
  }
  ProgramResult runIn(const std::string& sandbox) const {
    return runShell("bwrap --dev-bind / / " + sandbox + " bash -c " +
                    shellQuoted(commandLine(GetParam(), results_)));
  }

  fs::path results_ = scratchFolder() / "results";
  std::map<std::string, std::string> before_;
};

TEST_P(Unwritable, ReadOnlyFolderIsOneLine) {
  const std::string quoted = shellQuoted(results_.string());
  expectOneLine(runIn("--ro-bind " + quoted + " " + quoted));
  expectUnchanged(results_, before_);
}

// A file system of its own, on which the earlier results lie and something else takes all the rest.
TEST_P(Unwritable, FullDiskLosesNothing) {
  const fs::path kept = results_.parent_path() / "kept";
  fs::rename(results_, kept);
  fs::create_directories(results_);
  const std::string folder = shellQuoted(results_.string()), apart = shellQuoted(kept.string());
  const std::string fill = "mv " + apart + "/* " + folder + "; head -c 100M /dev/zero >" + folder +
                           "/rest 2>/dev/null; (" + commandLine(GetParam(), results_) + "); status=$?; rm " +
                           folder + "/rest; cp -r " + folder + "/. " + apart + "; exit $status";
  expectOneLine(
      runShell("bwrap --dev-bind / / --size 30000000 --tmpfs " + folder + " bash -c " + shellQuoted(fill)));
  expectUnchanged(kept, before_);
}
INSTANTIATE_TEST_SUITE_P(Of, Unwritable, testing::ValuesIn(quickCommands()), nameOfCommand);

TEST(UnwritableFolder, AFileInItsPlaceIsOneLine) {
  const fs::path folder = scratchFolder();
  inputFolder();
  writeNew(folder / "file", "mine");
  for (const WritingCommand& command : quickCommands()) expectOneLine(run(command, folder / "file"));
  EXPECT_EQ(readTextFile(folder / "file"), "mine");
}

// ---- two runs at once

class TwoAtOnce : public testing::TestWithParam<WritingCommand> {};

TEST_P(TwoAtOnce, AreAsOneOrOneIsRefused) {
  inputFolder();
  const fs::path results = scratchFolder() / "results";
  ASSERT_EQ(run(GetParam(), results).status, 0);
  const auto alone = contentsOf(results);
  const std::string command = "(" + commandLine(GetParam(), results) + ")";
  for (const char* lead_s : {"0", "0.3"}) {
    fs::remove_all(results);
    const auto both =
        runShell(command + " & sleep " + lead_s + "; " + command + "; second=$?; wait $!; echo $? $second");
    const std::string statuses = both.out.substr(both.out.rfind('\n', both.out.size() - 2) + 1);
    EXPECT_TRUE(statuses == "0 0\n" || statuses == "0 2\n" || statuses == "2 0\n") << both.out << both.err;
    if (statuses != "0 0\n") {
      EXPECT_NE(both.err.find("another run"), std::string::npos) << both.err;
      EXPECT_EQ(std::count(both.err.begin(), both.err.end(), '\n'), 1) << both.err;
    }
    expectUnchanged(results, alone);
  }
}
INSTANTIATE_TEST_SUITE_P(Of, TwoAtOnce,
                         testing::Values(writingCommand("simulate"), writingCommand("localize"),
                                         writingCommand("sil"), writingCommand("diagnose"),
                                         writingCommand("importvideo")),
                         nameOfCommand);

// One recording's images never come into another's. On a busy machine one may end before the other begins:
// they are started until they meet.
TEST(TwoSeedsAtOnce, GiveTheRecordingOfOne) {
  inputFolder();
  const fs::path results = scratchFolder() / "results";
  std::vector<std::map<std::string, std::string>> alone;
  std::string both;
  for (const char* seed : {"1", "2"}) {
    WritingCommand command = writingCommand("simulate");
    command.arguments += std::string(" --seed ") + seed;
    ASSERT_EQ(run(command, results).status, 0);
    alone.push_back(contentsOf(results));
    fs::remove_all(results);
    both += "(" + commandLine(command, results) + ") & ";
  }
  std::string err;
  for (int times = 0; times < 10 && err.empty(); ++times) {
    fs::remove_all(results);
    err = runShell(both + "wait").err;
    const auto files = contentsOf(results);
    EXPECT_TRUE(files == alone[0] || files == alone[1]) << namesIn(files);
  }
  EXPECT_NE(err.find("another run"), std::string::npos) << err;
}

TEST(Claims, EndWithTheirRun) {
  inputFolder();
  const fs::path folder = scratchFolder() / "results";
  {
    const FolderClaim claim(folder);
    expectBadInput(run(writingCommand("localize"), folder),
                   "results: another run is writing its results there");
  }
  EXPECT_FALSE(fs::exists(folder)) << "nothing was written";
  {
    const PendingFile rawlog(folder / "Fahrt ü 1_truth.tum");
    expectBadInput(run(writingCommand("simulate"), folder), "truth.tum: is being written by another run");
  }
  EXPECT_TRUE(contentsOf(folder).empty());
  EXPECT_EQ(run(writingCommand("simulate"), folder).status, 0);
}

// ---- inputs that point elsewhere

/// A recording whose images have other names: above its folder, absolute, a link.
fs::path pointingElsewhere(const fs::path& folder) {
  const RecordingFiles made = simulateForSil(folder);
  fs::create_directories(folder / "elsewhere");
  std::vector<Sample> samples;
  RawlogReader reader(made.rawlog);
  const RecordingHeader header = reader.header();
  while (auto sample = reader.next()) samples.push_back(std::move(*sample));
  RawlogWriter writer(folder / "r.rawlog", header, samples.front().time);
  int count = 0;
  for (Sample& sample : samples) {
    if (std::holds_alternative<RecordingHeader>(sample.reading)) continue;
    if (auto* image = std::get_if<ImageSample>(&sample.reading)) {
      const fs::path to = folder / "elsewhere" / std::to_string(count);
      fs::rename(made.images / image->file, to.string() + ".png");
      const std::string names[] = {"../elsewhere/0.png", to.string() + ".png", "link.png"};
      if (count == 2) fs::create_symlink(to.string() + ".png", made.images / "link.png");
      image->file = names[count++ % 3];
    }
    writer.write(sample);
  }
  writer.finish();
  return folder / "r.rawlog";
}

/// All files below a folder but results, and the detections that are kept beside a recording.
std::map<std::string, std::string> inputsIn(const fs::path& folder) {
  auto files = contentsOf(folder);
  std::erase_if(files, [](const auto& file) {
    return file.first.starts_with("out/") || file.first.starts_with("r_detections_");
  });
  return files;
}

TEST(PointingElsewhere, ImagesOfARecording) {
  const fs::path folder = scratchFolder();
  const std::string recording = " " + shellQuoted(pointingElsewhere(folder).string());
  const auto before = inputsIn(folder);
  const std::string water = " --water " + shellQuoted(kSilWater.string());
  for (const std::string& arguments :
       {"sil --sea-floor-z -6 --frames" + recording + water, "handles --no-simulation" + recording + water,
        "export csv" + recording, "export colmap" + recording, "diagnose --max-effects 1" + recording,
        "fit-water --search-steps 2 --images 3 --held-out 1" + recording + water,
        "compare-fiducials --backend aruco --preprocess none --recording" + recording}) {
    const auto result =
        runFathom(arguments + " --out " + shellQuoted((folder / "out" / arguments.substr(0, 4)).string()));
    EXPECT_TRUE(result.status == 0 || result.status == 2) << arguments << ": " << result.err;
    const auto after = inputsIn(folder);
    EXPECT_TRUE(after == before) << arguments << ": " << namesIn(after);
  }
}

TEST(PointingElsewhere, NamesOnAPanel) {
  const fs::path folder = scratchFolder();
  fs::create_directories(folder / "in/put");
  BoardFiles files;
  files.yaml = with(with(kBoardYaml, "panel: board", "panel: ../../evil"), "id: C3", "id: ../../../evil");
  const std::string map = shellQuoted(files.write(folder / "in/put").string());
  const auto before = inputsIn(folder);
  for (const std::string& arguments :
       {"map show " + map,
        "evaluate handles --views 1 --map " + map + " --vehicle " + kRov.string() +
            " --water ../../evil=" + kSilWater.string(),
        "simulate --duration 1 --trajectory " + (kConfig / "trajectory_station.yaml").string() +
            " --vehicle " + kRov.string() + " --map " + map + " --water " + kSilWater.string()}) {
    const auto result = runFathom(arguments + " --out " + shellQuoted((folder / "out").string()));
    EXPECT_EQ(result.status, 0) << arguments << ": " << result.err;
    EXPECT_TRUE(inputsIn(folder) == before) << arguments << ": " << namesIn(inputsIn(folder));
  }
}

TEST(PointingElsewhere, CornersOfImages) {
  const fs::path folder = scratchFolder();
  inputFolder();
  std::string table = readTextFile(inputFolder() / "Ecken é.csv");
  for (auto at = table.find("Bild "); at != std::string::npos; at = table.find("Bild "))
    table.replace(at, 5, "../../evil");
  writeNew(folder / "corners.csv", table);
  writeNew(folder / "camera.yaml", readTextFile(inputFolder() / "Kamera 1.yaml"));
  const auto before = inputsIn(folder);
  const auto result = runFathom("import corners --board 3x3 --square-m 0.03 --camera " +
                                shellQuoted((folder / "camera.yaml").string()) + " " +
                                shellQuoted((folder / "corners.csv").string()) + " --out " +
                                shellQuoted((folder / "out/a/b").string()));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(inputsIn(folder) == before) << namesIn(inputsIn(folder));
  for (const auto& [name, bytes] : contentsOf(folder / "out")) EXPECT_TRUE(name.starts_with("a/b/")) << name;
}

// From the copy, "../maps/board.yaml" would be the original, into which `handles` would write what it has
// read.
TEST(PointingElsewhere, AListOfPanelsByWayOfAFolderAbove) {
  const fs::path folder = scratchFolder();
  fs::create_directories(folder / "maps");
  BoardFiles().write(folder / "maps");
  const auto copied = [&](const std::string& name) {
    writeNew(folder / "maps/list.yaml", "panels: [" + name + "]\n");
    return copyPanelMap(folder / "maps/list.yaml", folder / "out");
  };
  const std::string up_and_down =
      fs::relative("/", folder / "maps").string() + "/.." + (folder / "maps/board.yaml").string();
  for (const std::string& name : {std::string("../maps/board.yaml"), up_and_down})
    EXPECT_THROW(copied(name), Error) << name;
  EXPECT_FALSE(fs::exists(folder / "out"));
  for (const fs::path& panel : panelMapFiles(copied("./board.yaml")))
    EXPECT_TRUE(panel.lexically_normal().string().starts_with((folder / "out").string())) << panel;
}

// A downloaded folder may hold such links: what they lead to is not ours to write.
TEST(PointingElsewhere, LinksInTheFolder) {
  const fs::path folder = scratchFolder(), results = folder / "results";
  inputFolder();
  writeNew(folder / "theirs", "theirs");
  fs::create_directories(results);
  const WritingCommand simulate = writingCommand("simulate");
  for (const char* name :
       {"Fahrt ü 1.rawlog.part", "Fahrt ü 1_truth.tum.part", "Fahrt ü 1_vehicle.yaml.part"}) {
    fs::create_symlink(folder / "theirs", results / name);
    expectOneLine(run(simulate, results));
    fs::remove(results / name);
  }
  for (const char* name : {"Fahrt ü 1.rawlog", "Fahrt ü 1_truth.tum"})
    fs::create_symlink(folder / "theirs", results / name);
  EXPECT_EQ(run(simulate, results).status, 0) << "a link itself is replaced";
  EXPECT_FALSE(fs::is_symlink(results / "Fahrt ü 1.rawlog"));
  EXPECT_EQ(readTextFile(folder / "theirs"), "theirs");
}

}  // namespace
}  // namespace fathom::test
