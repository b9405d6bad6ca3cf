#include "core/yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "core/files.h"

namespace fathom {

struct YamlMap::Known {
  std::string file;
  std::set<std::string> keys;  // dotted paths that somebody has asked for
};

namespace {

/// "camera.fx_px (line 3)"; of the whole file, "line 1".
std::string placeOf(const std::string& path, const YAML::Mark& mark) {
  if (mark.is_null()) return path;
  const std::string line = "line " + std::to_string(mark.line + 1);
  return path.empty() ? line : path + " (" + line + ")";
}

std::string join(const std::string& path, const std::string& key) {
  if (key.empty()) return path;
  return path.empty() ? key : path + "." + key;
}

std::string indexed(const std::string& key, std::size_t i) { return key + "[" + std::to_string(i) + "]"; }

constexpr std::size_t kLargestYaml_bytes = std::size_t{16}
                                           << 20;  // lists of ten thousand recordings are 1 MB
constexpr int kMaxNodes = 1'000'000;

/// Looks at every node once for duplicate keys. Bounds depth and number of nodes: with aliases a few lines
/// can contain themselves or stand for billions.
class StructureCheck {
 public:
  explicit StructureCheck(const std::string& file) : file_(file) {}

  void check(const YAML::Node& node, const std::string& path, int depth = 0) {
    if (depth > kMaxDepth || ++nodes_ > kMaxNodes)
      throw Error(file_, placeOf(path, node.Mark()), "nested too deep, or too large");
    if (node.IsMap()) {
      checkKeys(node, path);
      for (const auto& entry : node) check(entry.second, join(path, entry.first.Scalar()), depth + 1);
    } else if (node.IsSequence()) {
      for (std::size_t i = 0; i < node.size(); ++i) check(node[i], indexed(path, i), depth + 1);
    }
  }

 private:
  void checkKeys(const YAML::Node& map, const std::string& path) const {
    std::set<std::string> seen;
    for (const auto& entry : map) {
      const YAML::Mark mark = entry.first.Mark();
      if (!entry.first.IsScalar()) throw Error(file_, placeOf(path, mark), "a key must be a plain word");
      const auto& key = entry.first.Scalar();
      if (!seen.insert(key).second) throw Error(file_, placeOf(join(path, key), mark), "duplicate key");
    }
  }

  static constexpr int kMaxDepth = 16;
  const std::string& file_;
  int nodes_ = 0;
};

/// Counts what a parser finds: a node takes hundreds of times the bytes that it has in the file.
class NodeCount final : public YAML::EventHandler {
 public:
  using Mark = YAML::Mark;
  explicit NodeCount(const std::string& file) : file_(file) {}
  void OnDocumentStart(const Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const Mark& mark, YAML::anchor_t /*anchor*/) override { count(mark); }
  void OnAlias(const Mark& mark, YAML::anchor_t /*anchor*/) override { count(mark); }
  void OnScalar(const Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {
    count(mark);
  }
  void OnSequenceStart(const Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {
    count(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    count(mark);
  }
  void OnMapEnd() override {}

 private:
  void count(const Mark& mark) {
    if (++nodes_ > kMaxNodes) throw Error(file_, "line " + std::to_string(mark.line + 1), "too large");
  }

  const std::string& file_;
  int nodes_ = 0;
};

/// Not by YAML::LoadAll(): of a text that begins with a comma, yaml-cpp 0.7 makes empty documents without
/// end.
bool hasMoreThanOneDocument(const std::string& text, const std::string& file) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  NodeCount nodes(file);
  return parser.HandleNextDocument(nodes) && parser.HandleNextDocument(nodes);
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row.back();
}

/// The one of `keys` that is nearest to this one, at most so many edits away; lacking only its unit is none.
std::optional<std::string> nearestTo(const std::string& key, const std::set<std::string>& keys,
                                     std::size_t farthest) {
  std::optional<std::string> best;
  for (const auto& other : keys) {
    const std::size_t distance = other.starts_with(key + "_") ? 0 : editDistance(key, other);
    if (distance <= farthest) best = other, farthest = distance;
  }
  return best;
}

/// "; did you mean `x`?" for a key that is near, or that lacks only its unit.
std::string hint(const std::string& unknown, const std::set<std::string>& known) {
  const auto best = nearestTo(unknown, known, unknown.size() / 3 + 1);
  return best ? "; did you mean `" + best->substr(best->rfind('.') + 1) + "`?" : "";
}

void rejectUnknown(const YAML::Node& node, const std::string& path, const std::string& file,
                   const std::set<std::string>& known) {
  if (node.IsMap()) {
    for (const auto& entry : node) {
      const std::string key = join(path, entry.first.Scalar());
      if (!known.contains(key))
        throw Error(file, placeOf(key, entry.first.Mark()), "unknown key" + hint(key, known));
      rejectUnknown(entry.second, key, file, known);
    }
  } else if (node.IsSequence()) {
    for (std::size_t i = 0; i < node.size(); ++i) rejectUnknown(node[i], indexed(path, i), file, known);
  }
}

}  // namespace

YamlMap::YamlMap(const YAML::Node& node, std::string path, std::shared_ptr<Known> known)
    : node_(std::make_shared<const YAML::Node>(node)), path_(std::move(path)), known_(std::move(known)) {}

bool YamlMap::has(const std::string& key) const {
  known_->keys.insert(join(path_, key));
  return static_cast<bool>((*node_)[key]);
}

bool YamlMap::isList(const std::string& key) const { return has(key) && (*node_)[key].IsSequence(); }
bool YamlMap::isMap(const std::string& key) const { return has(key) && (*node_)[key].IsMap(); }

bool YamlMap::isEmpty(const std::string& key) const {
  if (!has(key)) return false;
  const YAML::Node node = (*node_)[key];
  return node.IsNull() || (node.IsScalar() && node.Scalar().empty());
}

YAML::Node YamlMap::child(const std::string& key) const {
  if (has(key)) return (*node_)[key];
  std::set<std::string> unknown;
  for (const std::string& present : keys())
    if (!known_->keys.contains(join(path_, present))) unknown.insert(present);
  for (const std::string& present : unknown)
    if (key.starts_with(present + "_")) throw error(present, "lacks its unit; did you mean `" + key + "`?");
  // Nearer than a hint asks for: what is not known yet may be asked for later.
  const auto meant = nearestTo(key, unknown, key.size() / 6);
  throw error("", "missing key `" + key + "`" + (meant ? "; is `" + *meant + "` meant for it?" : ""));
}

Error YamlMap::error(const std::string& key, const std::string& why) const {
  YAML::Mark mark = node_->Mark();
  for (const auto& entry : *node_)
    if (entry.first.Scalar() == key) mark = entry.first.Mark();
  return {known_->file, placeOf(join(path_, key), mark), why};
}

double YamlMap::toNumber(const YAML::Node& node, const std::string& key) const {
  if (!node.IsScalar() || node.Tag() == "!") throw error(key, "must be a number");
  const std::string& text = node.Scalar();
  // from_chars knows no plus sign.
  const char* first = text.data() + (text.starts_with('+') && !text.starts_with("+-") ? 1 : 0);
  double value = 0.0;
  const auto [end, problem] = std::from_chars(first, text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size())
    throw error(key, "must be a number, not `" + text + "`");
  if (!std::isfinite(value)) throw error(key, "must be finite, not `" + text + "`");
  return value;
}

double YamlMap::number(const std::string& key) const { return toNumber(child(key), key); }

double YamlMap::positive(const std::string& key) const {
  const double value = number(key);
  if (value <= 0.0) throw error(key, "must be greater than zero");
  return value;
}

double YamlMap::notNegative(const std::string& key) const {
  const double value = number(key);
  if (value < 0.0) throw error(key, "must not be negative");
  return value;
}

int YamlMap::integer(const std::string& key) const {
  const double value = number(key);
  if (value != std::round(value) || std::abs(value) > 1e9) throw error(key, "must be a whole number");
  return static_cast<int>(value);
}

bool YamlMap::flag(const std::string& key) const {
  const YAML::Node node = child(key);
  if (node.IsScalar() && node.Scalar() == "true") return true;
  if (node.IsScalar() && node.Scalar() == "false") return false;
  throw error(key, "must be true or false");
}

std::string YamlMap::text(const std::string& key) const {
  const YAML::Node node = child(key);
  if (!node.IsScalar() || node.Scalar().empty()) throw error(key, "must be a text");
  return node.Scalar();
}

std::vector<double> YamlMap::numbers(const std::string& key) const {
  const YAML::Node node = child(key);
  if (!node.IsSequence()) throw error(key, "must be a list of numbers");
  std::vector<double> values;
  for (const auto& entry : node) values.push_back(toNumber(entry, key));
  return values;
}

std::vector<double> YamlMap::matrix(const std::string& key) const {
  const YAML::Node node = child(key);
  if (!node.IsSequence() || node.size() == 0 || !node[0].IsSequence()) return numbers(key);
  std::vector<double> values;
  for (const auto& row : node) {
    if (!row.IsSequence() || row.size() != node[0].size())
      throw error(key, "must be a list of numbers, or of rows of the same length");
    for (const auto& entry : row) values.push_back(toNumber(entry, key));
  }
  return values;
}

Vector3d YamlMap::vector3(const std::string& key) const {
  const auto values = numbers(key);
  if (values.size() != 3) throw error(key, "must have three numbers, has " + std::to_string(values.size()));
  return {values[0], values[1], values[2]};
}

std::vector<std::string> YamlMap::texts(const std::string& key) const {
  const YAML::Node node = child(key);
  if (!node.IsSequence()) throw error(key, "must be a list");
  std::vector<std::string> values;
  for (const auto& entry : node) {
    if (!entry.IsScalar()) throw error(key, "must be a list of texts");
    values.push_back(entry.Scalar());
  }
  return values;
}

YamlMap YamlMap::map(const std::string& key) const {
  const YAML::Node node = child(key);
  if (!node.IsMap()) throw error(key, "must be a map");
  return {node, join(path_, key), known_};
}

std::vector<YamlMap> YamlMap::maps(const std::string& key) const {
  const YAML::Node node = child(key);
  if (!node.IsSequence()) throw error(key, "must be a list of maps");
  std::vector<YamlMap> entries;
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (!node[i].IsMap()) throw error(key, "entry " + std::to_string(i + 1) + " must be a map");
    entries.push_back(YamlMap(node[i], join(path_, indexed(key, i)), known_));
  }
  return entries;
}

Pose YamlMap::pose(const std::string& key) const {
  const YamlMap m = map(key);
  return {rotationFromYawPitchRoll(radians(m.number("yaw_deg")), radians(m.number("pitch_deg")),
                                   radians(m.number("roll_deg"))),
          Vector3d(m.number("x"), m.number("y"), m.number("z"))};
}

void YamlMap::read(const std::string& key, double& value) const {
  if (has(key)) value = number(key);
}
void YamlMap::read(const std::string& key, int& value) const {
  if (has(key)) value = integer(key);
}
void YamlMap::read(const std::string& key, bool& value) const {
  if (has(key)) value = flag(key);
}
void YamlMap::read(const std::string& key, std::string& value) const {
  if (has(key)) value = text(key);
}
void YamlMap::read(const std::string& key, Vector3d& value) const {
  if (has(key)) value = vector3(key);
}

std::vector<std::string> YamlMap::keys() const {
  std::vector<std::string> names;
  for (const auto& entry : *node_) names.push_back(entry.first.Scalar());
  return names;
}

YamlFile::YamlFile(const std::filesystem::path& file) : YamlFile(readTextFile(file), file.string()) {}

YamlFile YamlFile::parse(const std::string& text, const std::string& name) { return {text, name}; }

YamlFile::YamlFile(const std::string& text, const std::string& name) {
  if (text.size() > kLargestYaml_bytes)
    throw Error(name, "", "is larger than 16 MB: no YAML file of this program is");
  YAML::Node node;
  try {
    if (hasMoreThanOneDocument(text, name)) throw Error(name, "", "not YAML, or more than one document");
    node = YAML::Load(text);
  } catch (const YAML::Exception& e) {
    throw Error(name, "line " + std::to_string(e.mark.line + 1), "not YAML: " + e.msg);
  }
  if (!node.IsMap()) throw Error(name, "line 1", "must be a map of keys and values");
  StructureCheck(name).check(node, "");
  auto known = std::make_shared<YamlMap::Known>();
  known->file = name;
  root_ = YamlMap(node, "", known);
}

void YamlFile::rejectUnknownKeys() const {
  rejectUnknown(*root_->node_, "", root_->known_->file, root_->known_->keys);
}

}  // namespace fathom
