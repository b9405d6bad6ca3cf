#include "tasks/task_spec.h"

#include <algorithm>

namespace fathom {

bool TaskSpec::fusesLandmarks() const {
  return std::find(options.fuse.begin(), options.fuse.end(), Channel::landmark) != options.fuse.end();
}

LocalizationOptions readTask(const std::string& task) {
  const bool is_file = task.ends_with(".yaml");
  return readLocalizationOptions(is_file ? std::filesystem::path(task)
                                         : std::filesystem::path("config") / (task + ".yaml"));
}

}  // namespace fathom
