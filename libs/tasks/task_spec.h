#pragma once

#include <string>

#include "localization/options.h"

namespace fathom {

/// A task as it is to be run: one of the paper's, or what fathom makes of it.
struct TaskSpec {
  LocalizationOptions options;
  bool improved = false;

  /// For people: "TL5", "TL5 improved".
  std::string name() const { return options.task + (improved ? " improved" : ""); }
  /// For files and labels: "TL5", "TL5_IMPROVED".
  std::string id() const { return options.task + (improved ? "_IMPROVED" : ""); }
  bool fusesLandmarks() const;
};

/// A YAML file, or a name that stands for config/NAME.yaml. Throws Error.
LocalizationOptions readTask(const std::string& task);

}  // namespace fathom
