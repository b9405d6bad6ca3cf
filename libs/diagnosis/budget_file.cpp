#include "diagnosis/budget_file.h"

#include <array>
#include <stdexcept>
#include <utility>

#include "core/shipped_file.h"
#include "core/yaml.h"
#include "diagnosis/budget_columns.h"
#include "diagnosis/covariate.h"

namespace fathom {
namespace {

using Each = VarianceComponent::Each;

constexpr std::array<std::pair<const char*, Each>, 7> kEach{{{"recording", Each::recording},
                                                             {"sensor", Each::sensor},
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
  throw y.error("each", "must be recording, sensor, instrument, marker, place, image or reading");
}

SmoothField readSmooth(const YamlMap& y) {
  SmoothField smooth{y.texts("over"), y.numbers("length")};
  if (smooth.over.empty() || smooth.over.size() != smooth.length.size())
    throw y.error("length", "must have as many numbers as `over` has names, at least one");
  for (const double length : smooth.length)
    if (!(length > 0)) throw y.error("length", "must be above zero");
  for (const std::string& name : smooth.over)
    if (!isCovariate(name)) throw y.error("over", "`" + name + "` is nothing that readings depend on");
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
  try {
    columnsOf({}, component);
  } catch (const std::invalid_argument& e) {
    throw y.error("by", e.what());
  }
  component.source = y.text("source");
  return component;
}

ErrorBudget readBudget(const YamlFile& file) {
  const YamlMap& y = file.root();
  ErrorBudget budget;
  budget.name = y.text("name");
  budget.outlier_share = y.notNegative("outlier_share");
  if (budget.outlier_share >= 0.5) throw y.error("outlier_share", "must be below a half");
  budget.noise_factor = y.number("noise_factor");
  if (!(budget.noise_factor > 1)) throw y.error("noise_factor", "must be above one");
  const YamlMap components = y.map("components");
  for (const std::string& name : components.keys())
    budget.components.push_back(readComponent(components.map(name), name));
  file.rejectUnknownKeys();
  return budget;
}

}  // namespace

ErrorBudget readErrorBudget(const std::filesystem::path& file) { return readBudget(YamlFile(file)); }

ErrorBudget parseErrorBudget(const std::string& text, const std::string& name) {
  return readBudget(YamlFile::parse(text, name));
}

const ErrorBudget& fieldBudget() {
  static const ErrorBudget budget = readErrorBudget(shippedFile("config/error_budget.yaml"));
  return budget;
}

}  // namespace fathom
