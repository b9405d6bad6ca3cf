#pragma once

#include <filesystem>

namespace fathom {

/// Walks all records of a ROS 1 bag, version 2.0, also inside its chunks, and checks every length and offset.
/// rosbag_storage follows these without looking, and crashes on a damaged bag; after this check it can be let
/// loose. Format: wiki.ros.org/Bags/Format/2.0. Memory: one chunk.
/// Throws Error with the byte offset of the record that is damaged, cut off, or not of a bag at all.
void checkBag(const std::filesystem::path& file);

}  // namespace fathom
