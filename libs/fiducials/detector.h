#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fiducials/detection.h"
#include "fiducials/expected_marker.h"
#include "fiducials/preprocess.h"
#include "panel/marker_family.h"

/// Finding markers. A Detector is used by one thread at a time: run one a thread, over images.
namespace fathom {

/// Which library searches the image and reads the code.
enum class Backend { aruco, apriltag };
inline constexpr std::array kBackends{Backend::aruco, Backend::apriltag};
std::string_view nameOf(Backend backend);
std::vector<std::string> backendNames();
/// Throws std::invalid_argument, which names those there are.
Backend backendNamed(const std::string& name);
/// Another one, for what this one does not find.
Backend fallbackOf(Backend backend);
/// Whether its own corners are whole pixels, so that they should be refined; else they are good to a tenth.
bool hasRoughCorners(Backend backend);

/// Whether a backend can read a family. All read all of OpenCV's dictionaries and AprilTag's classic
/// families (tag16h5 … tag36h11); the newer ones (tagStandard41h12 …) only AprilTag.
bool canRead(Backend backend, const std::string& family, const MarkerLook& look = {});

struct DetectorOptions {
  MarkerLook look{};
  Preprocess preprocess = Preprocess::none;
  std::optional<GrayRange> expected_range;  ///< for Preprocess::stretch of 8 bits; absent: from the image
  bool refine = true;                       ///< corners by refineCorners() on the image as it came
  /// Where it is known, the lens's bending of straight edges is accounted for; images must be of its size.
  std::optional<CameraModel> camera;
  /// Wrong bits to forgive at most; the family's own distance and the memory of AprilTag's table may allow
  /// fewer.
  int largest_corrected_bits = 2;
};

/// The order of detections: by family, id, then place.
bool comesBefore(const Detection& a, const Detection& b);

/// Part of an image to search.
struct SearchRegion {
  cv::Rect area;
  double smallest_side_px = 0;  ///< of the markers expected in it; 0: unknown, search at full scale
};

class Detector {
 public:
  virtual ~Detector() = default;

  /// All markers in the image, gray or BGR, of 8 or 16 bits, sorted by family, id and place, without those
  /// that the image's border may cut off (a corner nearer to it than half a cell). The same image gives the
  /// same detections. Throws std::invalid_argument for another type of image or an empty one.
  std::vector<Detection> detect(const cv::Mat& image);
  /// The same within regions; they may overlap.
  virtual std::vector<Detection> detect(const cv::Mat& image, const std::vector<SearchRegion>& regions) = 0;
  /// One marker where it is expected, without a search: its edges fitted from there, its whole border and
  /// every bit of its code compared (as many wrong bits forgiven as elsewhere). Much faster than detect(),
  /// which may find what this does not: a marker partly covered, turned, or farther off than three sigma.
  /// `gray` is CV_8UC1, not preprocessed. Nothing, too, where refinement is off or the family's border is not
  /// a plain black one.
  virtual std::optional<Detection> confirm(const cv::Mat& gray, const ExpectedMarker& expected);
};

/// Throws std::invalid_argument: no family, an unknown one, or one that the backend cannot read, or not with
/// such a border.
std::unique_ptr<Detector> makeDetector(Backend backend, const std::vector<std::string>& families,
                                       const DetectorOptions& options = {});

/// Asks the first detector, and where it finds fewer markers than expected, the second too: the result is
/// the first's markers and those of the second's that are not among them.
class FallbackDetector : public Detector {
 public:
  FallbackDetector(std::unique_ptr<Detector> first, std::unique_ptr<Detector> second,
                   std::size_t expected_count = 1)
      : first_(std::move(first)), second_(std::move(second)), expected_count_(expected_count) {}

  using Detector::detect;
  std::vector<Detection> detect(const cv::Mat& image, const std::vector<SearchRegion>& regions) override;
  std::optional<Detection> confirm(const cv::Mat& gray, const ExpectedMarker& expected) override;

 private:
  std::unique_ptr<Detector> first_, second_;
  std::size_t expected_count_;
};

}  // namespace fathom
