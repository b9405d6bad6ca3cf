#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"

/// The strict JSON reader: an unknown, duplicate or missing key or a value of the wrong kind is an Error.
namespace fathom::sealed {

/// Throws Error where the text is no JSON or an object has a key twice.
nlohmann::json parseStrictJson(const std::string& text, const std::string& file);

/// An object of a JSON file. Reading a key marks it as known.
class JsonObject {
 public:
  /// `path`: of the object in the file, empty for the root. Throws Error where it is no object.
  JsonObject(const nlohmann::json& value, std::string file, std::string path);

  bool has(const std::string& key) const { return value_.contains(key); }
  double number(const std::string& key);
  std::uint64_t seed(const std::string& key);
  bool flag(const std::string& key);
  std::string text(const std::string& key);
  std::string oneOf(const std::string& key, const std::vector<std::string>& known);
  /// A number, or a list of them; `count` in all.
  std::vector<double> numbers(const std::string& key, std::size_t count);
  /// Such a list, or a list of such lists.
  std::vector<std::vector<double>> numberLists(const std::string& key, std::size_t count);
  JsonObject object(const std::string& key);
  std::vector<JsonObject> objects(const std::string& key);

  bool isNull(const std::string& key);
  void rejectUnknownKeys() const;
  Error error(const std::string& key, const std::string& why) const;

 private:
  const nlohmann::json& at(const std::string& key);
  std::vector<double> numbersIn(const nlohmann::json& value, const std::string& key, std::size_t count) const;
  std::string pathOf(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

  const nlohmann::json& value_;
  std::string file_, path_;
  std::set<std::string> known_;
};

}  // namespace fathom::sealed
