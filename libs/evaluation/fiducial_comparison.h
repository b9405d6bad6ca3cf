#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "evaluation/fiducial_grid.h"
#include "evaluation/marker_score.h"
#include "observables/views.h"
#include "sensors/vehicle.h"

/// Marker families and the libraries that read them, compared on images of one panel under water.
namespace fathom {

/// An image of the grid: the places of its factors in the grid's lists.
struct GridImage {
  std::size_t family = 0, range = 0, tilt = 0, repeat = 0, water = 0, blur = 0;
};

struct FiducialResult {
  GridImage image;
  std::size_t reader = 0;  ///< in readersOf(backends, preprocessings)
  ImageScore score;
  double detect_s = 0;  ///< CPU time of Detector::detect; measured, so another one each time
};

/// Where the camera stands; the same for every family, water and blur.
CameraView viewOf(const FiducialGrid& grid, const GridImage& image);

/// Makes the grid's images by the simulator's forward model and reads them: once rendered, a view goes
/// through every water (CameraStudio::lightIn), blur (cv::GaussianBlur on that light, borders mirrored) and
/// the sensor (CameraStudio::exposeLight, whose noise depends on seed, view, water and blur only). The panel
/// stands alone in endless water; with effects, what a marker should show is where it truly does. Of the
/// vehicle, camera and lamps count. All cores at once; the scores are the same on however many. Results are
/// in the order of families, ranges, tilts, repeats, waters, blurs, readers.
///
/// Goes on where an earlier run in the folder `chunks` was cut short (ChunkStore), or begins anew where
/// inputs differ. Throws Error as withFamily() does, Interrupted; std::invalid_argument where the grid's
/// lists are empty, the vehicle has no camera, or complaintAbout() has something to say.
std::vector<FiducialResult> compareFiducials(const FiducialGrid& grid, const PanelMap& map,
                                             const Vehicle& vehicle, const std::filesystem::path& chunks);

/// One image of the grid once more, to look at.
struct FiducialPicture {
  cv::Mat image_bgr;
  std::vector<MarkerPlace> places;                 ///< their markers are in the picture's map
  std::vector<std::vector<Detection>> detections;  ///< of each reader
  std::shared_ptr<const PanelMap> map;             ///< with the family's markers
};
std::vector<FiducialPicture> fiducialPictures(const FiducialGrid& grid, const PanelMap& map,
                                              const Vehicle& vehicle, const std::vector<GridImage>& images);

}  // namespace fathom
