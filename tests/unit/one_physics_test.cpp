// "Nobody else has an equation of a sensor": physics are in the rooms core (motion, rotations, the
// Gauss-Markov process), effects, sensors and imaging. The others call their forward model, and only who has
// a reason to.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "core/files.h"
#include "support/sanitized.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

const std::set<std::string> kPhysicsRooms{"effects", "sensors", "imaging"};

/// C++ without comments and what is in quotes, line by line as before.
std::string codeOf(const std::string& text) {
  enum class In { code, line, block, quotes } in = In::code;
  std::string code;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i], next = i + 1 < text.size() ? text[i + 1] : '\0';
    switch (in) {
      case In::code:
        if (c == '/' && next == '/') in = In::line;
        if (c == '/' && next == '*') in = In::block;
        if (c == '"') in = In::quotes;
        if (in == In::code || in == In::quotes) code += c;
        break;
      case In::line:
        if (c == '\n') in = In::code, code += c;
        break;
      case In::block:
        if (c == '\n') code += c;
        if (c == '*' && next == '/') in = In::code, ++i;
        break;
      case In::quotes:
        if (c == '\\') {
          ++i;
        } else if (c == '"') {
          in = In::code;
          code += c;
        }
        break;
    }
  }
  return code;
}

/// Sources by their path below libs/, of all rooms.
std::map<std::string, std::string> sources() {
  std::map<std::string, std::string> all;
  const fs::path libs = test::kSource / "libs";
  for (const auto& entry : fs::recursive_directory_iterator(libs))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
      all[fs::relative(entry.path(), libs)] = codeOf(readTextFile(entry.path()));
  return all;
}

std::string roomOf(const std::string& file) { return file.substr(0, file.find('/')); }

/// What an equation or constant of physics looks like, and the files outside of the rooms of physics that
/// have it all the same, for a reason.
struct Telltale {
  const char* what;
  std::regex looks;
  std::map<std::string, const char*> allowed;
};

std::vector<Telltale> telltales() {
  const char* const normal_curve = "a normal curve, of no light";
  return {
      {"gravity",
       std::regex(R"(\b9\.(8|79|78)\d*\b)"),
       {{"core/kinematics.h", "the definition, part of World"},
        {"sea_trial/import_sea_trial.cpp", "normal gravity of a place, for a vehicle file"}}},
      {"atmosphere, density of water, speed of sound",
       std::regex(R"(\b(101325|1025|1500)(\.0*)?\b)"),
       {{"ros_bag/bag_vehicle.cpp", "a vehicle file's generic data sheet"}}},
      {"a refractive index", std::regex(R"(\b1\.3[34]\d*\b)"), {}},
      {"the Earth's rotation", std::regex(R"(\b7\.29\d*e-0?5\b)"), {}},
      {"attenuation, or another decay",
       std::regex(R"(\bexp\(\s*-|\.exp\(\)|\bexpm1\(\s*-\s*[a-z]*attenuation)"),
       {{"core/gauss_markov.h", "the definition"},
        {"diagnosis/budget_columns.cpp", normal_curve},
        {"estimation/batch_state.h", "a factor that is estimated by its logarithm, of no way through water"},
        {"fiducials/corner_refinement.cpp", normal_curve},
        {"observables/edge_blur.cpp", normal_curve},
        {"similarity/phase_congruency.cpp", normal_curve},
        {"reports/water_report.cpp", "an image's gain, taken out of what is plotted"}}},
      {"attenuation by hand",
       std::regex(R"(attenuation_per_m(\[\w+\])?\s*\*|\*\s*[\w.>-]*attenuation_per_m)"),
       {}},
      {"the response's curve", std::regex(R"(\bpow\([^;]*\b(gamma|response_gamma|curve\.exponent)\b)"), {}},
      {"rounding's variance of an image's numbers",
       std::regex(R"(1 << [\w.]*bits\) - 1\)?\s*\*\s*std::sqrt)"),
       {}},
      {"a sensor on a lever arm",
       std::regex(R"((rate|omega|angular_velocity|acceleration)\w*\.cross\()"),
       {{"core/pose_spline.h", "the body's own motion"},
        {"ros_bag/mounting_checks.cpp", "omega x v, the body's own motion"}}},
      {"hydrostatics", std::regex(R"(\b(density|rho)\w*\s*\*|atmospheric_pressure\w*\s*[-+])"), {}},
      {"lens distortion",
       std::regex(R"(\bk1\)?\s*[*+]|\*\s*(T\()?[\w.]*\bk1\b)"),
       {{"core/camera_model.h", "the definition"}}},
      {"refraction", std::regex(R"(\basin\(|\bsnell\b)", std::regex::icase), {}},
      {"Rodrigues' formula beside expSO3()",
       std::regex(R"(\bRodrigues\(|1(\.0)? - (std::)?cos\((angle|theta|phi)|crossMatrix\b[^;]*\bsin\()"),
       {{"core/geometry.h", "the definition"}}},
      {"the spline's weights",
       std::regex(R"(3\.0 \* u\b|\bu3 / 6)"),
       {{"core/pose_spline.h", "the definition"}}},
  };
}

/// "libs/FILE: LINE", of what is nowhere allowed.
std::vector<std::string> findings(const Telltale& telltale, const std::string& file,
                                  const std::string& code) {
  std::vector<std::string> found;
  if (kPhysicsRooms.contains(roomOf(file)) || telltale.allowed.contains(file)) return found;
  for (std::size_t begin = 0; begin < code.size();) {
    const std::size_t end = std::min(code.find('\n', begin), code.size());
    const std::string line = code.substr(begin, end - begin);
    if (std::regex_search(line, telltale.looks)) found.push_back("libs/" + file + ": " + line);
    begin = end + 1;
  }
  return found;
}

TEST(OnePhysics, NobodyElseHasAnEquation) {
  if (test::kSanitized) GTEST_SKIP() << "a text, the same in each build";
  const auto all = sources();
  for (const Telltale& telltale : telltales()) {
    for (const auto& [file, code] : all)
      for (const std::string& found : findings(telltale, file, code))
        ADD_FAILURE() << found << "\nlooks like " << telltale.what
                      << ": call the forward model instead (libs/sensors, libs/imaging), or say here why not";
    for (const auto& [file, reason] : telltale.allowed) {
      ASSERT_TRUE(all.contains(file)) << file << " is gone";
      EXPECT_TRUE(std::regex_search(all.at(file), telltale.looks)) << file << " needs no leave any more";
    }
  }
}

// The copies that there have been, as they were.
TEST(OnePhysics, ACopyIsFound) {
  const std::vector<std::string> copies{
      "  const double passed = std::exp(-a * z_m);",
      "  const double through = std::exp(-environment.water.attenuation_per_m[kGreen] * std::max(0.0, z_m));",
      "    const Vector3d passed = (-z_m * water.attenuation_per_m).array().exp();",
      "constexpr double kGravity = 9.80665;",
      "      : sigma_(sigma), decay_(std::exp(-interval_s / time_constant_s)) {}",
      "                       angular_velocity_robot.cross(dvl->T_robot_dvl.position);",
      "  turning_ += rate.cross(velocity);",
      "constexpr double kEarthRate = 7.292115e-5;",
      "    const double reading = std::pow(patch.radiance[c], patch.response_gamma) - response.offset;",
      "    value = {(5.0 + 3.0 * u - 3.0 * u2 + u3) / 6.0, (1.0 + 3.0 * u + 3.0 * u2 - 2.0 * u3) / 6.0, u3 / "
      "6.0};",
      "         sigmaLine(\"water_density_kg_m3\", {}, 1025);",
      "  const double pressure_pa = surface_pa - density_kg_m3 * 9.81 * z_m;",
  };
  const auto all = telltales();
  for (const std::string& copy : copies) {
    std::size_t found = 0;
    for (const Telltale& telltale : all)
      found += findings(telltale, "localization/new.cpp", codeOf(copy)).size();
    EXPECT_GT(found, 0u) << copy;
  }
  // Comments and texts may name what they like.
  for (const std::string harmless : {"// exp(-a z)", "  text = \"exp(-a z)\";", "/* 9.81 */ int x;"})
    for (const Telltale& telltale : all)
      EXPECT_TRUE(findings(telltale, "localization/new.cpp", codeOf(harmless)).empty()) << harmless;
}

/// What a room asks sensors' forward models for, and which of them.
struct Asker {
  const char* reason;
  std::set<std::string> models;
};

const std::map<std::string, Asker> kAskers{
    {"localization",
     {"the filter compares with them, and starts by them", {"modelOf", "Attitude::orientation"}}},
    {"estimation",
     {"the batch compares with them",
      {"modelOf", "predictDetectedCorners", "predictPatch", "predictBlur", "predictSpecks",
       "predictTexture"}}},
    {"environment",
     {"the water's fit, and what its advice is made of",
      {"predictLight", "predictPatchLight", "predictPatchReading", "predictReading"}}},
    {"diagnosis", {"plans what would be seen of a manoeuvre", {"predictCorners"}}},
    {"fiducials",
     {"gray levels to expect; where a pinhole would look for a marker",
      {"predictLight", "predictReading", "predictCorners"}}},
    {"landmarks",
     {"how fast the robot was when an image was taken", {"Gyro::angularVelocity", "Dvl::velocity"}}},
    {"audit",
     {"what is put back where a driver took it out; the depth that a pressure is",
      {"Accelerometer::specificForce", "Depth::pressure"}}},
    {"sea_trial", {"whether a trial's streams agree", {"Accelerometer::specificForce", "Dvl::velocity"}}},
    {"ros_bag", {"the pressure that a depth is", {"Depth::pressure"}}},
};

/// predictLight(), …, as the rooms of physics declare them.
std::set<std::string> forwardModels(const std::map<std::string, std::string>& all) {
  const std::regex declared(R"(\b(predict[A-Z]\w*)\s*\()");
  std::set<std::string> models;
  for (const auto& [file, code] : all)
    if (kPhysicsRooms.contains(roomOf(file)) && file.ends_with(".h"))
      for (std::sregex_iterator it(code.begin(), code.end(), declared), end; it != end; ++it)
        models.insert((*it)[1]);
  return models;
}

/// What calls a forward model: predictLight(), …, of an instrument's channel by any name, or Dvl::velocity(),
/// ….
const std::regex kCall(
    R"(\b(predict[A-Z]\w*|modelOf(?=\([\w.]*[cC]hannel)|(?:Gyro|Accelerometer|Attitude|Dvl|DvlBeams|Depth|Usbl|Compass|Gnss|Altimeter)::(?!mountings|values|channel)[a-z]\w*)\s*(<\w*>)?\s*\()");

TEST(OnePhysics, WhoAsksTheForwardModelIsListed) {
  if (test::kSanitized) GTEST_SKIP() << "a text, the same in each build";
  const auto all = sources();
  const auto models = forwardModels(all);
  EXPECT_GE(models.size(), 5u);
  for (const auto& [file, code] : all)
    for (std::sregex_iterator it(code.begin(), code.end(), kCall), end; it != end; ++it) {
      const std::string model = (*it)[1];
      if (kPhysicsRooms.contains(roomOf(file)) || (model.starts_with("predict") && !models.contains(model)))
        continue;
      const auto asker = kAskers.find(roomOf(file));
      EXPECT_TRUE(asker != kAskers.end() && asker->second.models.contains((*it)[1]))
          << "libs/" << file << " calls " << (*it)[1] << "(): say who asks it, and why, if there is a reason";
    }
}

}  // namespace
}  // namespace fathom
