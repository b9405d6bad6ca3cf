#pragma once

#include <filesystem>
#include <optional>

#include "recording/imported.h"

/// Videos, with a table of when each frame was taken.
namespace fathom {

struct VideoImport {
  std::filesystem::path video, stamps, vehicle;
  std::filesystem::path recording;  ///< whose samples the frames are put between; empty: none
  int every = 1;      ///< of the frames that are asked for and have a stamp, only each so-manyth
  bool grey = false;  ///< images of one channel
  /// By stamps, from the first one on: frames only, the recording is taken whole.
  std::optional<double> from_s, to_s;
};

/// What the recording's first comment says: a description, and the map of the recording that is joined, as
/// the folder `target` sees it. Throws Error.
RecordingHeader headerOf(const VideoImport& source, const std::filesystem::path& target);

/// Hands on the frames as entries CAMERA of the vehicle file's camera, and the samples of the recording, in
/// order of time; of equal stamps the recording's come first. Frames become PNG files in `image_folder`,
/// which all appear there when the video has been read to its end. One frame is in memory at a time. The
/// whole video is decoded whatever is asked for of it: only so is it known that its frames and the stamps are
/// as many.
///
/// Of the recording, entries that are none of the convention's or have no stamp are left out, and counted. It
/// may be out of order by up to kReorder_s.
///
/// Throws Error, and leaves the folder as it was: video or stamps cannot be read, are damaged, or do not fit
/// each other; frames of another size than the vehicle's camera; nothing is left of what is asked for; the
/// recording has images, too, or no time in common with the frames.
ImportedRecording streamVideo(const VideoImport& source, const std::filesystem::path& image_folder,
                              const SampleSink& sink);
inline constexpr double kReorder_s = 5;

}  // namespace fathom
