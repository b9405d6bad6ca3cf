#include "sil/pair_store.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/fingerprint.h"
#include "core/text.h"
#include "image_files/encode_image.h"
#include "image_files/image_file.h"
#include "imaging/fingerprints.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {
using Json = nlohmann::ordered_json;

/// All that a pair depends on beside the inputs that all have in common.
std::string fingerprintOf(const PosedImage& posed) {
  Fingerprint fingerprint;
  fingerprint.add(readTextFile(posed.image.file)).add(fingerprintOf(posed.image.camera));
  add(fingerprint, posed.T_odom_robot.pose);
  add(fingerprint, posed.T_odom_camera());
  for (const Vector3d& velocity :  // what a rolling shutter shows of them
       {posed.camera.projector.velocity_camera, posed.camera.projector.angular_velocity_camera})
    fingerprint.add(velocity.data(), sizeof(double) * 3);
  fingerprint.add(posed.t_s).add(static_cast<double>(posed.panel));
  return fingerprint.hex();
}

/// Names that filesOf() gives, and such files' unfinished parts: six digits, then a word.
bool isOurs(const std::string& name) {
  const auto digits = name.find_first_not_of("0123456789");
  if (digits == std::string::npos || digits < 6) return false;
  const std::string rest = name.substr(digits);
  return rest.starts_with("_recorded.") || rest.starts_with("_simulated.") || rest.starts_with("_panel.") ||
         rest.starts_with("_frame.");
}

Json toJson(const PairRecord& record) {
  Json json{{"why_not", record.why_not},
            {"range_m", record.range_m},
            {"view_angle_rad", record.view_angle_rad},
            {"panel_share", record.panel_share},
            {"values", Json::array()},
            {"unmeasured", record.unmeasured}};
  for (const auto& value : record.values) json["values"].push_back(value ? Json(*value) : Json(nullptr));
  return json;
}

PairRecord recordFrom(const Json& json) {
  PairRecord record{
      json.at("why_not"),   json.at("range_m"), json.at("view_angle_rad"), json.at("panel_share"), {},
      json.at("unmeasured")};
  for (const Json& value : json.at("values"))
    record.values.push_back(value.is_null() ? std::nullopt : std::optional(value.get<double>()));
  return record;
}

}  // namespace

PairStore::PairStore(const fs::path& folder, const std::string& name, const std::string& inputs)
    : images_(imageFolder(folder, name)), chunks_(folder / "chunks", inputs) {
  fs::create_directories(images_);
}

fs::path PairStore::imageFolder(const fs::path& folder, const std::string& name) {
  return folder / (name + "_pairs_Images");
}

PairFiles PairStore::filesOf(const PosedImage& posed) {
  const std::string number = print("%06zu", posed.number);
  return {number + "_recorded" + posed.image.file.extension().string(), number + "_simulated.png",
          number + "_panel.png"};
}

std::string PairStore::fingerprintOfImages(const PosedImage& posed) const {
  Fingerprint fingerprint;
  for (const std::string& file : filesOf(posed).all())
    fingerprint.add(isThere(images_ / file) ? readTextFile(images_ / file) : "");
  return fingerprint.hex();
}

std::optional<PairRecord> PairStore::read(const PosedImage& posed) const {
  const auto text = chunks_.read(posed.number);
  if (!text || !isThere(posed.image.file)) return std::nullopt;
  const Json json = Json::parse(*text);
  if (json.at("of") != fingerprintOf(posed)) return std::nullopt;
  PairRecord record = recordFrom(json);
  if (record.why_not.empty() && json.at("images") != fingerprintOfImages(posed)) return std::nullopt;
  return record;
}

void PairStore::write(const PosedImage& posed, const PairRecord& record, const SilPair* pair) const {
  Json json = toJson(record);
  json["of"] = isThere(posed.image.file) ? fingerprintOf(posed) : "";
  if (pair != nullptr) {
    const PairFiles files = filesOf(posed);
    writeTextFile(images_ / files.recorded, readTextFile(posed.image.file));
    writeTextFile(images_ / files.simulated, pngBytes(pair->images.simulated));
    writeTextFile(images_ / files.panel, pngBytes(pair->images.panel_mask));
    json["images"] = fingerprintOfImages(posed);
  }
  chunks_.write(posed.number, json.dump() + "\n");
}

ImagePair PairStore::readImages(const fs::path& image_folder, const PosedImage& posed,
                                const PairMaker& maker) {
  const PairFiles files = filesOf(posed);
  ImagePair pair;
  pair.recorded = inColour(maker.readRecorded(image_folder / files.recorded, posed.image.camera));
  pair.simulated = inColour(readImage(image_folder / files.simulated));
  pair.panel_mask = readImage(image_folder / files.panel);
  pair.camera = &maker.camera();
  return pair;
}

void keepOnly(const fs::path& folder, const std::set<std::string>& files) {
  if (!isFolder(folder)) return;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!isOurs(name) || files.contains(name)) continue;
    std::error_code problem;
    if (!fs::remove(entry.path(), problem))
      throw Error(entry.path().string(), "", "cannot be removed: " + problem.message());
  }
}

}  // namespace fathom
