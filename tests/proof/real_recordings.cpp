#include "real_recordings.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"

namespace fathom::proof {
namespace fs = std::filesystem;
namespace {

constexpr int kSeaTrialSections = 7;

RealRecording seaTrial(const fs::path& tables, int section) {
  return {print("akit-%d", section),
          print("sea trial, section %d: INS and DVL, mountings unknown", section),
          {"csv", tables, "--section", std::to_string(section), "--undo-stamp-stretch"},
          {"--max-effects", "6"}};
}

std::vector<RealRecording> throughWater(const fs::path& data) {
  const fs::path tank = data / "tank", views = data / "two_view", dome = data / "dome";
  return {{"tank",
           "one image of three boards through water, as if in air",
           {"corners", tank / "corners.csv", "--camera", tank / "camera.yaml"},
           {}},
          {"two_view",
           "fish in an aquarium by two cameras, as if in air",
           {"tie-points", views / "detections.csv", "--left", views / "camera1.yaml", "--right",
            views / "camera2.yaml"},
           {}},
          {"dome",
           "37 images through a dome, calibrated on 109 in air",
           {"corners", dome / "water_corners.csv", "--board", "8x6", "--square-m", "0.03", "--calibrate",
            dome / "air_corners.csv", "--image-size", "1440x1080"},
           {}}};
}

std::string numbersIn(const nlohmann::json& value) {
  std::string text;
  for (const nlohmann::json& number : value.is_array() ? value : nlohmann::json::array({value}))
    text += (text.empty() ? "" : ", ") + (number.is_number() ? print("%.4g", number.get<double>()) : "-");
  return value.is_array() ? "(" + text + ")" : text;
}

/// "flat-port-refraction: slab_m 0.243 ± 0.007, …"
std::string described(const nlohmann::json& effect) {
  std::string text;
  for (const auto& [name, value] : effect.at("parameters").items()) {
    text += (text.empty() ? ": " : ", ") + name + " " + numbersIn(value);
    if (effect.at("sigma").contains(name)) text += " ± " + numbersIn(effect.at("sigma").at(name));
  }
  return effect.at("name").get<std::string>() + text;
}

std::string allDescribed(const nlohmann::json& effects) {
  std::string text;
  for (const nlohmann::json& effect : effects) text += (text.empty() ? "" : "; ") + described(effect);
  return text;
}

}  // namespace

std::vector<RealRecording> realRecordings(const fs::path& data, bool quick) {
  std::vector<RealRecording> all;
  for (const RealRecording& recording : throughWater(data))
    if (fs::exists(data / recording.name) && (!quick || recording.name == "tank")) all.push_back(recording);
  for (int section = 1; section <= kSeaTrialSections; ++section)
    if (fs::exists(data / "akit") && !quick) all.push_back(seaTrial(data / "akit", section));
  return all;
}

nlohmann::ordered_json answerTo(const RealRecording& recording, const Programs& programs,
                                const fs::path& folder) {
  nlohmann::ordered_json answer{{"name", recording.name}, {"what", recording.what}, {"failure", ""}};
  fs::create_directories(folder);
  std::vector<std::string> import{programs.fathom, "import"};
  import.insert(import.end(), recording.import.begin(), recording.import.end());
  import.insert(import.end(), {"--name", "recording", "--out", folder});
  std::vector<std::string> diagnose{programs.fathom, "diagnose", folder / "recording.rawlog", "--out",
                                    folder};
  diagnose.insert(diagnose.end(), recording.diagnose.begin(), recording.diagnose.end());
  try {
    runProgram(import, folder / "import.log");
    runProgram(diagnose, folder / "diagnose.log");
    const auto result = nlohmann::json::parse(readTextFile(folder / "result.json"));
    for (const char* part : {"verdict", "why", "effects", "remainder", "alternatives", "heldout"})
      answer[part] = result.at("diagnosis").at(part);
  } catch (const Error& error) {
    answer["failure"] = error.what();
  }
  return answer;
}

Table realTable(const std::vector<nlohmann::json>& answers) {
  Table table{
      {"recording", "verdict", "effects", "held out", "before", "after", "95 %", "black box", "noise"}, {}};
  for (const nlohmann::json& answer : answers) {
    const std::string title = print("%s (%s)", answer.at("name").get<std::string>().c_str(),
                                    answer.at("what").get<std::string>().c_str());
    if (const std::string failure = answer.at("failure"); !failure.empty()) {
      table.rows.push_back({title, "failed", failure});
      continue;
    }
    const nlohmann::json& heldout = answer.at("heldout");
    const auto number = [&](const char* key) { return numbersIn(heldout.at(key)); };
    table.rows.push_back({title, answer.at("verdict"), allDescribed(answer.at("effects")),
                          heldout.at("metric").is_null() ? "-" : heldout.at("metric").get<std::string>(),
                          number("before"), number("after"), number("after_ci95"), number("black_box"),
                          number("noise_floor")});
  }
  return table;
}

}  // namespace fathom::proof
