#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/geometry.h"

/// The strict YAML reader: an unknown, duplicate or missing key, a value of the wrong kind, NaN or infinity,
/// a number with letters behind it and broken syntax are each an Error that names file, key and line.
namespace YAML {
class Node;
}

namespace fathom {

class YamlFile;

/// A map in a YAML file. Reading a key marks it as known; YamlFile::rejectUnknownKeys() complains about the
/// rest.
class YamlMap {
 public:
  bool has(const std::string& key) const;

  bool isList(const std::string& key) const;
  bool isMap(const std::string& key) const;
  bool isEmpty(const std::string& key) const;  ///< there, but without a value, or with an empty text

  double number(const std::string& key) const;
  double positive(const std::string& key) const;     ///< > 0
  double notNegative(const std::string& key) const;  ///< >= 0
  int integer(const std::string& key) const;
  bool flag(const std::string& key) const;
  std::string text(const std::string& key) const;
  std::vector<double> numbers(const std::string& key) const;
  /// A list of numbers, or one of rows of numbers, of the same length: row by row.
  std::vector<double> matrix(const std::string& key) const;
  Vector3d vector3(const std::string& key) const;  ///< [x, y, z]
  std::vector<std::string> texts(const std::string& key) const;
  YamlMap map(const std::string& key) const;
  std::vector<YamlMap> maps(const std::string& key) const;  ///< a list of maps

  /// {x, y, z, yaw_deg, pitch_deg, roll_deg}, metres and degrees, MRPT order.
  Pose pose(const std::string& key) const;

  /// Overwrites value where the key is present: for options whose default is the member initialiser.
  void read(const std::string& key, double& value) const;
  void read(const std::string& key, int& value) const;
  void read(const std::string& key, bool& value) const;
  void read(const std::string& key, std::string& value) const;
  void read(const std::string& key, Vector3d& value) const;

  std::vector<std::string> keys() const;  ///< all keys present, in file order; does not mark them known
  /// An Error at this key (or, with an empty key, at the map itself).
  Error error(const std::string& key, const std::string& why) const;

 private:
  friend class YamlFile;
  struct Known;
  YamlMap(const YAML::Node& node, std::string path, std::shared_ptr<Known> known);
  YAML::Node child(const std::string& key) const;
  double toNumber(const YAML::Node& node, const std::string& key) const;

  std::shared_ptr<const YAML::Node> node_;
  std::string path_;  ///< dotted path of this map in the file, "" for the root
  std::shared_ptr<Known> known_;
};

class YamlFile {
 public:
  /// Throws Error where the file is missing, is not YAML, has a duplicate key, or is no map at its root.
  explicit YamlFile(const std::filesystem::path& file);
  /// The same from text; `name` stands for the file in errors.
  static YamlFile parse(const std::string& text, const std::string& name);

  const YamlMap& root() const { return *root_; }
  /// Call when all that is known has been read. Names the nearest known key as a hint.
  void rejectUnknownKeys() const;

 private:
  YamlFile(const std::string& text, const std::string& name);
  std::optional<YamlMap> root_;
};

}  // namespace fathom
