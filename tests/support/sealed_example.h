#pragma once

#include <string>

#include "sealed/sealed_case.h"

namespace fathom::sealed {

/// For tests: a short dive without noise that hides `effects`, a JSON list.
inline std::string exampleCaseText(const std::string& effects = "[]", const std::string& camera = "corners",
                                   const std::string& outside = "[]") {
  return R"({"name": "example", "dive": {"manoeuvre": "rich", "seed": 3, "duration_s": 6, "camera": ")" +
         camera +
         R"(", "image_rate_hz": 0.3, "water": "clear"}, "seed": 17, "noise": false, "rich": false, "effects": )" +
         effects + R"(, "outside": )" + outside + "}";
}
inline SealedCase exampleCase(const std::string& effects = "[]", const std::string& camera = "corners") {
  return parseSealedCase(exampleCaseText(effects, camera), "case.json");
}

}  // namespace fathom::sealed
