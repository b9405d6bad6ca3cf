#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "effects/registry.h"
#include "fiducials/detector.h"
#include "imaging/water.h"

/// What fiducial markers are compared under. See config/compare_fiducials.yaml.
namespace fathom {

/// What searches an image: a library, after a preprocessing.
struct FiducialReader {
  Backend backend = Backend::aruco;
  Preprocess preprocess = Preprocess::none;

  std::string name() const;  ///< "aruco", "aruco+clahe"
};

/// Every backend with every preprocessing.
std::vector<FiducialReader> readersOf(const std::vector<Backend>& backends,
                                      const std::vector<Preprocess>& preprocessings);

/// A detector as `fathom detect` has it by default: ArUco's corners, which are whole pixels of a contour, are
/// fitted to the edges' pixels; AprilTag's own are good to a tenth of a pixel.
std::unique_ptr<Detector> makeDetector(const FiducialReader& reader, const std::vector<std::string>& families,
                                       const MarkerLook& look, const CameraModel& camera);

/// Water and daylight; lamps are off but for effects.
struct NamedWater {
  std::string name;
  Water water;
  Vector3d ambient = Vector3d::Ones();
};

/// Every family under every combination of the other factors. An image is one view of the panel with one
/// family's markers through one water with one blur; every reader reads it.
struct FiducialGrid {
  std::vector<std::string> families{"DICT_ARUCO_ORIGINAL", "DICT_4X4_50", "DICT_6X6_250", "tag16h5",
                                    "tag36h11"};
  std::vector<Backend> backends{kBackends.begin(), kBackends.end()};
  std::vector<Preprocess> preprocessings{Preprocess::none};
  std::vector<double> ranges_m{1, 1.5, 2, 3, 4, 6};  ///< to the panel's centre
  std::vector<double> tilts_rad{radians(0), radians(20), radians(40), radians(60)};  ///< from its normal
  std::vector<NamedWater> waters{{"clear", {{0.32, 0.07, 0.05}, {0.02, 0.14, 0.22}}, {0.78, 0.92, 0.95}},
                                 {"moderate", {{0.42, 0.20, 0.19}, {0.03, 0.17, 0.20}}, {0.75, 0.86, 0.82}},
                                 {"murky", {{0.68, 0.37, 0.37}, {0.04, 0.20, 0.21}}, {0.68, 0.83, 0.77}},
                                 {"turbid", {{1.10, 0.68, 0.74}, {0.05, 0.24, 0.22}}, {0.62, 0.80, 0.72}}};
  /// Sigma of a Gaussian over the light that reaches the sensor, before exposure: what a lens out of focus or
  /// a small motion does, equal in all directions. 0: none but the pixel's own width.
  std::vector<double> blurs_px{0, 1, 2};
  int repeats = 7;      ///< views of each range and tilt: from another side, rolled, aimed elsewhere
  double match_px = 3;  ///< a marker is found where no corner is off by more
  std::uint64_t seed = 1;
  /// In the images, see ViewStudio; readers and poses know nothing of them.
  EffectParameters<double> effects;
  double t_s = 0;  ///< of every view, see CameraView

  std::size_t viewCount() const { return ranges_m.size() * tilts_rad.size() * std::size_t(repeats); }
  std::size_t imageCount() const { return families.size() * viewCount() * waters.size() * blurs_px.size(); }
};

/// All but effects. Strict, see core/yaml.h; keys that are left out keep their defaults. Throws Error: an
/// empty list, an entry there twice, an unknown family, backend or preprocessing, or a family that a backend
/// cannot read.
FiducialGrid readFiducialGrid(const std::filesystem::path& file);

/// What is wrong with these lists; empty where nothing is.
std::string complaintAbout(const std::vector<std::string>& families, const std::vector<Backend>& backends);
/// Throws std::invalid_argument for an unknown name.
Preprocess preprocessNamed(const std::string& name);

}  // namespace fathom
