#pragma once

#include <filesystem>

namespace fathom {

struct BagOptions {
  /// Messages lie in a bag in the order of their arrival; entries are put in the order of their header stamps
  /// as long as none is later than this behind its successors.
  double reorder_window_s = 5.0;
  /// Images are written here as they are met, so that memory stays bounded; needed where the map has a
  /// CAMERA. Raw ones as PNG, compressed ones as they are.
  std::filesystem::path image_folder;
  /// A message that cannot be used is an error, else it is left out and counted.
  bool strict = false;
};

}  // namespace fathom
