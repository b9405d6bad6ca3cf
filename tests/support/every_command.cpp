#include "support/every_command.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "core/text.h"
#include "support/shipped.h"
#include "support/small_imports.h"
#include "support/small_vehicle.h"

namespace fathom::test {
namespace fs = std::filesystem;
namespace {

fs::path folderOfThisProcess() {
  return fs::temp_directory_path() / "fathom-tests" / ("dive – Tauchgang " + std::to_string(getpid()));
}

const std::string kRecorded = "Fahrt ü 1";

/// A panel's map and its mesh; OBJ names its materials without blanks.
void copyPanel(const fs::path& folder) {
  fs::copy_file(kDexrovMap.parent_path() / "panel.obj", folder / "Tafel ß.obj");
  fs::copy_file(kDexrovMap.parent_path() / "panel.mtl", folder / "panel.mtl");
  writeNew(folder / "panel übersicht.yaml", with(readTextFile(kDexrovMap), "panel.obj", "Tafel ß.obj"));
}

void makeRecording(const fs::path& folder) {
  fs::rename(writeSmallVehicle(folder), folder / "Fahrzeug ö.yaml");
  fs::copy_file(kConfig / "trajectory_station.yaml", folder / "Bahn ß.yaml");
  fs::copy_file(kConfig / "water_clear.yaml", folder / "Wasser klar.yaml");
  const auto made = run(writingCommand("simulate"), folder);
  if (made.status != 0) throw std::runtime_error(made.err);
}

void makeRest(const fs::path& folder) {
  writeSmallBag(folder);
  writeSmallCorners(folder);
  writeSmallBoard(folder);
  writeSmallSeaTrial(folder);
  writeSmallTiePoints(folder);
  writeSmallVideo(folder);
  fs::copy_file(kSource / "tests/fuzz/corpus/opencv.yaml", folder / "Eichung ä.yaml");
  writeNew(folder / "Störung.yaml",
           "faults:\n  - {name: drop, kind: drop, sensors: [DVL], vary: probability, strengths: [0.5]}\n");
  writeNew(folder / "Stapel ü.yaml", "recordings: [\"" + (folder / (kRecorded + ".rawlog")).string() +
                                         "\"]\nruns:\n  - {name: filter, command: localize}\n");
}

/// The folder with all inputs, and its end with the process.
struct Inputs {
  Inputs() {
    fs::remove_all(folder);
    fs::create_directories(folder);
    copyPanel(folder);
    makeRest(folder);
  }
  ~Inputs() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  fs::path folder = folderOfThisProcess();
};

}  // namespace

std::ostream& operator<<(std::ostream& out, const WritingCommand& command) { return out << command.name; }

fs::path inputFolder() {
  static const Inputs inputs;
  static const bool recorded = (makeRecording(inputs.folder), true);
  return recorded ? inputs.folder : fs::path();
}

std::vector<WritingCommand> writingCommands() {
  const auto in = [](const std::string& name) {
    return shellQuoted((folderOfThisProcess() / name).string());
  };
  const std::string recording = " " + in(kRecorded + ".rawlog"), map = " --map " + in("panel übersicht.yaml"),
                    vehicle = " --vehicle " + in("Fahrzeug ö.yaml"),
                    water = " --water " + in("Wasser klar.yaml"),
                    image = " " + in(kRecorded + "_Images/CAMERA_0001.png");
  return {
      {"simulate",
       "simulate --duration 2.5 --name '" + kRecorded + "' --trajectory " + in("Bahn ß.yaml") + vehicle +
           map + water,
       ""},
      {"localize", "localize --smooth" + recording, ""},
      {"tasks", "localize" + recording + " --tasks config/TL5.yaml", ""},
      {"smooth", "smooth" + recording, ""},
      {"stress", "stress --paper-only --faults " + in("Störung.yaml") + recording, ""},
      {"diagnose", "diagnose --max-effects 1" + recording, ""},
      {"fitwater", "fit-water --search-steps 2 --images 3 --held-out 1" + recording + water, ""},
      {"sil", "sil --sea-floor-z -6 --frames" + recording + water, ""},
      {"handles", "handles --no-simulation --every 3" + recording + water, ""},
      {"evaluatehandles", "evaluate handles --views 1" + map + vehicle + water, ""},
      {"evaluatepanel", "evaluate panel --views 1" + map + vehicle + water, ""},
      {"fiducials", "compare-fiducials --backend aruco --preprocess none --recording" + recording, ""},
      {"detect", "detect --family DICT_ARUCO_ORIGINAL" + image, "Funde ü.csv"},
      {"map", "map show " + in("panel übersicht.yaml"), ""},
      {"importbag", "import bag " + in("Bandaufnahme ä.bag") + " --topics " + in("Themen ö.yaml"), ""},
      {"importcsv", "import csv --section 1 " + in("Tabellen ö"), ""},
      {"importcorners",
       "import corners --board 3x3 --square-m 0.03 --camera " + in("Kamera 1.yaml") + " " + in("Ecken é.csv"),
       ""},
      {"calibratecamera",
       "calibrate camera --board 4x3 --square-m 0.05 --image-size 640x480 --air " + in("Schachbrett ü.csv"),
       ""},
      {"importtiepoints",
       "import tie-points --left " + in("Kamera links.yaml") + " --right " + in("Kamera rechts.yaml") + " " +
           in("Punkte ä.csv"),
       ""},
      {"importvideo", "import video " + in("Film ö.avi") + " --stamps " + in("Stempel ü.csv") + vehicle, ""},
      {"importcamera", "import camera " + in("Eichung ä.yaml"), ""},
      {"exportcsv", "export csv" + recording, ""},
      {"exporttum", "export tum" + recording, "Weg ü.tum"},
      {"exportkml", "export kml --latitude 43 --longitude 5" + recording, "Karte ü.kml"},
      {"exportcolmap", "export colmap" + recording, ""},
      {"batch", "batch " + in("Stapel ü.yaml"), ""},
      {"man", "man", ""}};
}

WritingCommand writingCommand(const std::string& name) {
  const auto all = writingCommands();
  return *std::find_if(all.begin(), all.end(), [&](const WritingCommand& c) { return c.name == name; });
}

std::string commandLine(const WritingCommand& command, const fs::path& results) {
  const fs::path out = command.out_file.empty() ? results : results / command.out_file;
  return "cd " + shellQuoted(kSource.string()) + "; exec " + shellQuoted(fathomProgram()) + " " +
         command.arguments + " --out " + shellQuoted(out.string());
}

ProgramResult run(const WritingCommand& command, const fs::path& results) {
  return runShell(commandLine(command, results));
}

}  // namespace fathom::test
