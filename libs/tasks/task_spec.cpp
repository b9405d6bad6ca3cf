#include "tasks/task_spec.h"

#include <algorithm>

#include "core/shipped_file.h"

namespace fathom {

bool TaskSpec::fusesLandmarks() const {
  return std::find(options.fuse.begin(), options.fuse.end(), kChannel<Landmark>) != options.fuse.end();
}

LocalizationOptions readTask(const std::string& task) {
  const bool is_file = task.ends_with(".yaml");
  return readLocalizationOptions(shippedFile(is_file ? task : "config/" + task + ".yaml"));
}

}  // namespace fathom
