#include "strict_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace fathom::sealed {
namespace {

using nlohmann::json;

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

json parseStrictJson(const std::string& text, const std::string& file) {
  std::vector<std::set<std::string>> open;  // keys of the objects around
  const auto watchKeys = [&](int, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::object_start) open.emplace_back();
    if (event == json::parse_event_t::object_end) open.pop_back();
    if (event == json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second)
      throw Error(file, parsed.get<std::string>(), "is there twice");
    return true;
  };
  try {
    return json::parse(text, watchKeys);
  } catch (const json::parse_error& problem) {
    throw Error(file, "byte " + std::to_string(problem.byte), "is no JSON");
  }
}

JsonObject::JsonObject(const json& value, std::string file, std::string path)
    : value_(value), file_(std::move(file)), path_(std::move(path)) {
  if (!value_.is_object()) throw Error(file_, path_, "must be an object");
}

Error JsonObject::error(const std::string& key, const std::string& why) const {
  return {file_, pathOf(key), why};
}

const json& JsonObject::at(const std::string& key) {
  known_.insert(key);
  if (!value_.contains(key)) throw error(key, "is missing");
  return value_.at(key);
}

double JsonObject::number(const std::string& key) { return numbers(key, 1).front(); }

std::uint64_t JsonObject::seed(const std::string& key) {
  if (!at(key).is_number_unsigned()) throw error(key, "must be a whole number, not negative");
  return at(key).get<std::uint64_t>();
}

bool JsonObject::flag(const std::string& key) {
  if (!at(key).is_boolean()) throw error(key, "must be true or false");
  return at(key).get<bool>();
}

std::string JsonObject::text(const std::string& key) {
  if (!at(key).is_string()) throw error(key, "must be text");
  return at(key).get<std::string>();
}

std::string JsonObject::oneOf(const std::string& key, const std::vector<std::string>& known) {
  std::string word = text(key);
  if (std::find(known.begin(), known.end(), word) == known.end())
    throw error(key, "unknown: `" + word + "`; there are " + listed(known));
  return word;
}

std::vector<double> JsonObject::numbers(const std::string& key, std::size_t count) {
  return numbersIn(at(key), key, count);
}

std::vector<std::vector<double>> JsonObject::numberLists(const std::string& key, std::size_t count) {
  const json& value = at(key);
  if (!value.is_array() || value.empty() || !value.front().is_array()) return {numbersIn(value, key, count)};
  std::vector<std::vector<double>> lists;
  for (const json& entry : value) lists.push_back(numbersIn(entry, key, count));
  return lists;
}

std::vector<double> JsonObject::numbersIn(const json& value, const std::string& key,
                                          std::size_t count) const {
  const json list = value.is_array() ? value : json::array({value});
  if (list.size() != count)
    throw error(key,
                count == 1 ? "must be a number" : "must be a list of " + std::to_string(count) + " numbers");
  std::vector<double> values;
  for (const json& entry : list) {
    if (!entry.is_number() || !std::isfinite(entry.get<double>()))
      throw error(key, "must be a finite number");
    values.push_back(entry.get<double>());
  }
  return values;
}

JsonObject JsonObject::object(const std::string& key) { return {at(key), file_, pathOf(key)}; }

std::vector<JsonObject> JsonObject::objects(const std::string& key) {
  if (!at(key).is_array()) throw error(key, "must be a list");
  std::vector<JsonObject> all;
  for (const json& entry : at(key))
    all.emplace_back(entry, file_, pathOf(key) + "[" + std::to_string(all.size()) + "]");
  return all;
}

bool JsonObject::isNull(const std::string& key) { return !has(key) || at(key).is_null(); }

void JsonObject::rejectUnknownKeys() const {
  for (const auto& entry : value_.items())
    if (!known_.contains(entry.key())) throw error(entry.key(), "unknown key");
}

}  // namespace fathom::sealed
