#include "panel/obj_outline.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <sstream>

#include "core/error.h"
#include "core/files.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr const char* kBlank = " \t\r";

std::vector<std::string> wordsOf(const std::string& line) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; (begin = line.find_first_not_of(kBlank, begin)) != std::string::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlank, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

/// The whole word, or nothing.
template <class Number>
std::optional<Number> parsed(const std::string& word) {
  Number value{};
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (problem != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The line being read.
struct Place {
  const fs::path& file;
  int line = 0;

  Error error(const std::string& why) const { return {file.string(), "line " + std::to_string(line), why}; }
};

using TakeWords = std::function<void(const Place& place, const std::vector<std::string>& words)>;

/// Calls `take` for every line that is neither blank nor a comment.
void forEachLine(const fs::path& file, const TakeWords& take) {
  std::istringstream text(readTextFile(file));
  Place place{file};
  for (std::string line; std::getline(text, line);) {
    ++place.line;
    const auto words = wordsOf(line);
    if (!words.empty() && !words.front().starts_with('#')) take(place, words);
  }
}

Eigen::Vector3f threeNumbers(const Place& place, const std::vector<std::string>& words) {
  Eigen::Vector3f values;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto value = i + 1 < words.size() ? parsed<float>(words[i + 1]) : std::nullopt;
    if (!value || !std::isfinite(*value)) throw place.error("`" + words[0] + "` needs three numbers");
    values[static_cast<Eigen::Index>(i)] = *value;
  }
  return values;
}

using Materials = std::map<std::string, Eigen::Vector3f>;

void readMaterials(const fs::path& file, Materials& albedo) {
  std::optional<Place> open;  // a material that has no colour yet
  std::string name;
  const auto close = [&] {
    if (open) throw open->error("material `" + name + "` has no Kd, its albedo");
  };
  forEachLine(file, [&](const Place& place, const std::vector<std::string>& words) {
    if (words[0] == "newmtl") {
      close();
      if (words.size() != 2) throw place.error("`newmtl` needs one name");
      name = words[1];
      if (albedo.contains(name)) throw place.error("material `" + name + "` is defined twice");
      open.emplace(place);
    } else if (words[0] == "Kd") {
      if (!open) throw place.error("`Kd` without a material before it, or a second one");
      const Eigen::Vector3f kd = threeNumbers(place, words);
      if (kd.minCoeff() < 0.0f || kd.maxCoeff() > 1.0f)
        throw place.error("Kd is the linear albedo, from 0 to 1");
      albedo[name] = kd;
      open.reset();
    }
  });
  close();
}

/// `5`, `5/1`, `5//2`, `5/1/2`; negative ones count back from the latest vertex. From 0.
int cornerVertex(const Place& place, const std::string& word, int vertices) {
  const auto number = parsed<int>(word.substr(0, word.find('/')));
  if (!number || *number == 0 || word.ends_with('/'))
    throw place.error("`" + word + "` is no vertex of a face");
  const long index = *number > 0 ? *number - 1L : static_cast<long>(vertices) + *number;
  if (index < 0 || index >= vertices)
    throw place.error("names vertex " + word + ", and there are " + std::to_string(vertices) + " before it");
  return static_cast<int>(index);
}

std::vector<int> corners(const Place& place, const std::vector<std::string>& words, int vertices) {
  // What OpenMesh does with a face takes the square of its vertices.
  constexpr std::size_t kMostCorners = 1000;
  if (words.size() > kMostCorners + 1) throw place.error("a face of more than 1000 vertices");
  std::vector<int> indices;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const int index = cornerVertex(place, words[i], vertices);
    if (std::find(indices.begin(), indices.end(), index) != indices.end())
      throw place.error("the face has vertex " + words[i] + " twice");
    indices.push_back(index);
  }
  if (indices.size() < 3) throw place.error("a face needs three vertices");
  return indices;
}

}  // namespace

ObjOutline readObjOutline(const fs::path& file) {
  ObjOutline outline;
  std::string object, material;
  forEachLine(file, [&](const Place& place, const std::vector<std::string>& words) {
    const std::string& keyword = words[0];
    if (keyword == "v") {
      threeNumbers(place, words);
      ++outline.vertices;
    } else if (keyword == "f") {
      if (material.empty()) throw place.error("a face without a material (`usemtl`) has no colour");
      outline.faces.push_back({place.line, corners(place, words, outline.vertices), object, material});
    } else if (keyword == "o" || keyword == "g") {
      object = words.size() > 1 ? words[1] : "";
    } else if (keyword == "mtllib") {
      if (words.size() != 2) throw place.error("`mtllib` needs one file name without blanks");
      const fs::path library = file.parent_path() / words[1];
      if (!isFile(library)) throw place.error("material library " + library.string() + " is missing");
      readMaterials(library, outline.albedo);
    } else if (keyword == "usemtl") {
      material = words.size() > 1 ? words[1] : "";
      if (!outline.albedo.contains(material))
        throw place.error("material `" + material + "` is in no material library");
    }
  });
  return outline;
}

}  // namespace fathom
