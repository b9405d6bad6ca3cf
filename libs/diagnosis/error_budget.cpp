#include "diagnosis/error_budget.h"

#include <array>
#include <cmath>
#include <utility>

#include "core/yaml.h"

namespace fathom {
namespace {

using Each = VarianceComponent::Each;

constexpr double kSigmasOf99 = 2.576;  // of a normal variable, two-sided

constexpr std::array<std::pair<const char*, Each>, 6> kEach{{{"recording", Each::recording},
                                                             {"instrument", Each::instrument},
                                                             {"marker", Each::marker},
                                                             {"place", Each::place},
                                                             {"image", Each::image},
                                                             {"reading", Each::reading}}};

Each readEach(const YamlMap& y) {
  if (!y.has("each")) return Each::recording;
  const std::string text = y.text("each");
  for (const auto& [name, each] : kEach)
    if (text == name) return each;
  throw y.error("each", "must be recording, instrument, marker, place, image or reading");
}

SmoothField readSmooth(const YamlMap& y) {
  SmoothField smooth{y.texts("over"), y.numbers("length")};
  if (smooth.over.empty() || smooth.over.size() != smooth.length.size())
    throw y.error("length", "must have as many numbers as `over` has names, at least one");
  for (const double length : smooth.length)
    if (!(length > 0)) throw y.error("length", "must be above zero");
  return smooth;
}

VarianceComponent readComponent(const YamlMap& y, const std::string& name) {
  VarianceComponent component;
  component.name = name;
  component.by = y.texts("by");
  if (component.by.empty()) throw y.error("by", "must name what it acts by");
  component.each = readEach(y);
  if (y.has("smooth")) component.smooth = readSmooth(y.map("smooth"));
  component.sigma = y.positive("sigma");
  component.factor = y.number("factor");
  if (!(component.factor > 1)) throw y.error("factor", "must be above one");
  component.unit = y.text("unit");
  component.source = y.text("source");
  return component;
}

ErrorBudget readBudget(const YamlFile& file) {
  const YamlMap& y = file.root();
  ErrorBudget budget;
  budget.name = y.text("name");
  budget.outlier_share = y.notNegative("outlier_share");
  if (budget.outlier_share >= 0.5) throw y.error("outlier_share", "must be below a half");
  const YamlMap components = y.map("components");
  for (const std::string& name : components.keys())
    budget.components.push_back(readComponent(components.map(name), name));
  file.rejectUnknownKeys();
  return budget;
}

}  // namespace

double VarianceComponent::logSd() const { return std::log(factor) / kSigmasOf99; }

ErrorBudget ErrorBudget::read(const std::filesystem::path& file) { return readBudget(YamlFile(file)); }
ErrorBudget ErrorBudget::parse(const std::string& text, const std::string& name) {
  return readBudget(YamlFile::parse(text, name));
}

}  // namespace fathom
