#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "evaluation/fiducial_grid.h"
#include "evaluation/marker_score.h"
#include "recording/rawlog.h"

/// The libraries that find markers, compared on a recording's images.
namespace fathom {

struct RecordedImage {
  std::filesystem::path file;
  CameraModel camera;
  Pose T_robot_camera;
  std::optional<Pose> T_odom_robot;  ///< truth of the same instant, where the recording has it
};

/// All images that a recording names, in its order, of a pair the left one first; reads it to its end. Some
/// hundred bytes an image. Throws Error as RawlogReader does.
std::vector<RecordedImage> recordedImages(RawlogReader& reader);

struct RecordedFiducialsOptions {
  std::vector<std::string> families;
  std::vector<FiducialReader> readers;
  /// Tells which ids there are and, with truth, what should be found. Null: neither is known.
  std::shared_ptr<const PanelMap> map;
  double match_px = 3;  ///< a marker is found, and two readers agree, where no corner is off by more
};

/// What one reader made of one image.
struct RecordedReading {
  int detections = 0;
  int not_on_map = 0;   ///< of these, where there is a map
  ImageScore score;     ///< all 0 where truth or map is unknown
  double detect_s = 0;  ///< CPU time of Detector::detect; measured
};

/// How far two readers saw the same.
struct ReaderAgreement {
  int both = 0;  ///< the same family and id at the same place
  int only_first = 0, only_second = 0;
  double squares_px2 = 0;  ///< sum of squared distances of the corners of what both saw, four each
};

struct RecordedResult {
  bool truth_known = false;                 ///< score counts
  std::vector<RecordedReading> readings;    ///< of each reader
  std::vector<ReaderAgreement> agreements;  ///< of each pair: 0 1, 0 2, …, 1 2, …
};

/// Compares what two readers found.
ReaderAgreement agreementOf(const std::vector<Detection>& first, const std::vector<Detection>& second,
                            double match_px);

/// One image, to look at.
struct RecordedPicture {
  cv::Mat image;                                   ///< CV_8UC1 or CV_8UC3 (BGR)
  std::optional<std::vector<MarkerPlace>> places;  ///< where truth and map are known
  std::vector<std::vector<Detection>> detections;  ///< of each reader
};
std::vector<RecordedPicture> recordedPictures(const std::vector<RecordedImage>& images,
                                              const RecordedFiducialsOptions& options);

/// Reads all images with all readers, all cores at once; goes on where an earlier run in the folder `chunks`
/// was cut short (ChunkStore; an image that has changed since is read anew). Throws Error: an image is
/// missing, damaged or not of its camera's size; Interrupted.
std::vector<RecordedResult> readRecordedFiducials(const std::vector<RecordedImage>& images,
                                                  const RecordedFiducialsOptions& options,
                                                  const std::filesystem::path& chunks);

}  // namespace fathom
