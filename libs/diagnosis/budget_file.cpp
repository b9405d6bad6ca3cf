#include "diagnosis/budget_file.h"

#include <yaml-cpp/yaml.h>

#include <array>
#include <stdexcept>
#include <utility>

#include "core/shipped_file.h"
#include "core/text.h"
#include "core/yaml.h"
#include "diagnosis/budget_columns.h"
#include "diagnosis/covariate.h"

namespace fathom {
namespace {

using Each = VarianceComponent::Each;

constexpr std::array<std::pair<const char*, Each>, 9> kEach{{{"recording", Each::recording},
                                                             {"sensor", Each::sensor},
                                                             {"instrument", Each::instrument},
                                                             {"marker", Each::marker},
                                                             {"place", Each::place},
                                                             {"spot", Each::spot},
                                                             {"image", Each::image},
                                                             {"image and colour", Each::image_colour},
                                                             {"reading", Each::reading}}};

constexpr const char* kProcessed = "processed";

std::string nameOf(Each each) {
  for (const auto& [name, known] : kEach)
    if (known == each) return name;
  return {};
}

Each readEach(const YamlMap& y) {
  if (!y.has("each")) return Each::recording;
  const std::string text = y.text("each");
  for (const auto& [name, each] : kEach)
    if (text == name) return each;
  throw y.error(
      "each",
      "must be recording, sensor, instrument, marker, place, spot, image, image and colour, or reading");
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

VarianceComponent::Processed readProcessed(const YamlMap& y) {
  const VarianceComponent::Processed processed{y.positive("sigma"), y.number("factor")};
  if (!(processed.factor > 1)) throw y.error("factor", "must be above one");
  return processed;
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
  if (y.has("processed")) component.processed = readProcessed(y.map("processed"));
  component.of_processed_only = y.has("only") && y.text("only") == kProcessed;
  if (y.has("only") && !component.of_processed_only) throw y.error("only", "must be `processed`");
  component.unit = y.text("unit");
  try {
    columnsOf({}, component);
  } catch (const std::invalid_argument& e) {
    throw y.error("by", e.what());
  }
  for (const std::string& by : component.by)
    if (const std::string unit = unitOf(by); !unit.empty() && unit != component.unit)
      throw y.error("unit", print("must be `%s`, which %s is in", unit.c_str(), by.c_str()));
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

template <class Values, class Text>
void writeList(YAML::Emitter& out, const char* key, const Values& values, Text&& text) {
  out << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (const auto& value : values) out << text(value);
  out << YAML::EndSeq;
}

void writeComponent(YAML::Emitter& out, const VarianceComponent& component) {
  const auto asItIs = [](const std::string& text) { return text; };
  out << YAML::Key << component.name << YAML::Value << YAML::BeginMap;
  writeList(out, "by", component.by, asItIs);
  out << YAML::Key << "each" << YAML::Value << nameOf(component.each);
  if (component.smooth) {
    out << YAML::Key << "smooth" << YAML::Value << YAML::Flow << YAML::BeginMap;
    writeList(out, "over", component.smooth->over, asItIs);
    writeList(out, "length", component.smooth->length, [](double length) { return shortest(length); });
    out << YAML::EndMap;
  }
  out << YAML::Key << "sigma" << YAML::Value << print("%.3g", component.sigma);
  out << YAML::Key << "factor" << YAML::Value << print("%.3g", component.factor);
  if (component.processed) {
    out << YAML::Key << kProcessed << YAML::Value << YAML::Flow << YAML::BeginMap;
    out << YAML::Key << "sigma" << YAML::Value << print("%.3g", component.processed->sigma);
    out << YAML::Key << "factor" << YAML::Value << print("%.3g", component.processed->factor) << YAML::EndMap;
  }
  if (component.of_processed_only) out << YAML::Key << "only" << YAML::Value << kProcessed;
  out << YAML::Key << "unit" << YAML::Value << YAML::DoubleQuoted << component.unit;
  out << YAML::Key << "source" << YAML::Value << YAML::DoubleQuoted << component.source << YAML::EndMap;
}

}  // namespace

std::string formatErrorBudget(const ErrorBudget& budget, const std::string& comment) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "name" << YAML::Value << YAML::DoubleQuoted << budget.name;
  out << YAML::Key << "outlier_share" << YAML::Value << shortest(budget.outlier_share);
  out << YAML::Key << "noise_factor" << YAML::Value << shortest(budget.noise_factor);
  out << YAML::Key << "components" << YAML::Value << YAML::BeginMap;
  for (const VarianceComponent& component : budget.components) writeComponent(out, component);
  out << YAML::EndMap << YAML::EndMap;
  return "# " + comment + "\n" + out.c_str() + "\n";
}

ErrorBudget readErrorBudget(const std::filesystem::path& file) { return readBudget(YamlFile(file)); }

ErrorBudget parseErrorBudget(const std::string& text, const std::string& name) {
  return readBudget(YamlFile::parse(text, name));
}

const ErrorBudget& fieldBudget() {
  static const ErrorBudget budget = readErrorBudget(shippedFile("config/error_budget.yaml"));
  return budget;
}

const ErrorBudget& laboratoryBudget() {
  static const ErrorBudget budget = readErrorBudget(shippedFile("config/laboratory_budget.yaml"));
  return budget;
}

}  // namespace fathom
