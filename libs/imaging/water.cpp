#include "imaging/water.h"

#include "core/yaml.h"

namespace fathom {
namespace {

/// Three numbers, none below zero.
Vector3d readColour(const YamlMap& y, const std::string& key) {
  Vector3d colour = y.vector3(key);
  if (colour.minCoeff() < 0) throw y.error(key, "must not be below zero");
  return colour;
}

Water readWater(const YamlMap& y) {
  Water water{readColour(y, "attenuation_per_m"), readColour(y, "veil")};
  if (water.veil.maxCoeff() > 1) throw y.error("veil", "must not be above 1, the camera's full scale");
  return water;
}

}  // namespace

Environment readEnvironment(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  const YamlMap& y = yaml.root();
  Environment environment;
  environment.water = readWater(y.map("water"));
  environment.ambient = readColour(y, "ambient");
  if (y.has("lamps_irradiance_1m")) environment.lamps_irradiance_1m = readColour(y, "lamps_irradiance_1m");
  yaml.rejectUnknownKeys();
  return environment;
}

Vector9d waterParameters(const Environment& environment) {
  Vector9d parameters;
  parameters << environment.water.attenuation_per_m, environment.water.veil, environment.ambient;
  return parameters;
}

Environment environmentOf(const Vector9d& parameters) {
  return {{parameters.head<3>(), parameters.segment<3>(3)}, parameters.tail<3>(), {}};
}

Vector9d wideWaterSigma() {
  constexpr double kAttenuation_per_m = 2.0, kVeil = 0.5, kAmbient = 1.0;
  Vector9d sigma;
  sigma << Vector3d::Constant(kAttenuation_per_m), Vector3d::Constant(kVeil), Vector3d::Constant(kAmbient);
  return sigma;
}

}  // namespace fathom
