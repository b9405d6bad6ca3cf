#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/run_info.h"
#include "report/table.h"
#include "sil/recorded_handles.h"

/// What `fathom handles` tells: tables, plots, files.
namespace fathom {

struct HandlesStory {
  RunInfo run;
  std::string recording, map, vehicle, water, truth;  ///< files; the last one may be empty
  std::size_t window = 0;
  std::vector<PanelMap> panels;       ///< with the handles' angles that were read
  std::vector<PanelMap> true_panels;  ///< empty: not known
  PosedImages images;
  std::vector<HandleSight> recorded, simulated;
  std::vector<HandleState> states;
  std::vector<std::filesystem::path> pictures;  ///< to be shown in the report
  std::vector<std::string> remarks;
};

/// One row a handle: its angle in the map and as read, truth where known.
Table stateTable(const HandlesStory& story, const std::vector<PanelMap>& as_mapped);
/// One row a reason why images have no angle of a handle.
Table unreadTable(const HandlesStory& story);

/// handles.csv (one line an image and handle, `nan` for what is absent), result.json and report.html. Throws
/// Error.
void writeOutputs(const HandlesStory& story, const std::vector<PanelMap>& as_mapped,
                  const std::filesystem::path& folder);

}  // namespace fathom
