#include "sil/export_colmap.h"

#include <array>
#include <map>

#include "core/files.h"
#include "core/text.h"

namespace fathom {
namespace {

constexpr double kFromCorner_px = 0.5;  // COLMAP's (0, 0) is the image's corner, not a pixel's centre

std::string lineOf(const CameraModel& c, std::size_t id) {
  const bool fisheye = c.lens == LensModel::fisheye;
  std::string line =
      print("%zu %s %d %d %.12g %.12g %.12g %.12g", id, fisheye ? "OPENCV_FISHEYE" : "FULL_OPENCV",
            c.width_px, c.height_px, c.fx_px, c.fy_px, c.cx_px + kFromCorner_px, c.cy_px + kFromCorner_px);
  for (const LensCoefficient& k : coefficientsOf(fisheye ? LensModel::fisheye : LensModel::rational))
    line += print(" %.12g", c.*k.value);
  return line + "\n";
}

/// The markers' corners as points of the world, with the images that show them.
class CornerPoints {
 public:
  explicit CornerPoints(const std::vector<PanelMap>& panels) {
    for (const PanelMap& panel : panels)
      for (const Marker& marker : panel.markers) {
        auto& first = first_[{marker.family, marker.id}];
        first = points_.size() + 1;
        for (const Vector3d& corner : marker.corners_panel())
          points_.push_back({panel.T_odom_panel * corner, {}});
      }
  }

  /// The second line of an image's two: X Y POINT3D_ID.
  std::string seen(const std::vector<Detection>& detections, std::size_t image) {
    std::string line;
    std::size_t index = 0;
    for (const Detection& detection : detections) {
      const auto first = first_.find({detection.family, detection.id});
      if (first == first_.end()) continue;
      for (std::size_t k = 0; k < 4; ++k, ++index) {
        const std::size_t id = first->second + k;
        const Vector2d& pixel = detection.corners_px[k];
        line += print("%s%.4f %.4f %zu", index == 0 ? "" : " ", pixel.x() + kFromCorner_px,
                      pixel.y() + kFromCorner_px, id);
        points_[id - 1].track += print(" %zu %zu", image, index);
      }
    }
    return line;
  }

  std::string lines() const {
    std::string text = "# POINT3D_ID X Y Z R G B ERROR TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (const auto& [p, track] = points_[i]; !track.empty())
        text += print("%zu %.9f %.9f %.9f 255 255 255 0", i + 1, p.x(), p.y(), p.z()) + track + "\n";
    return text;
  }

 private:
  struct Point {
    Vector3d position_odom;
    std::string track;
  };
  std::vector<Point> points_;
  std::map<std::pair<std::string, int>, std::size_t> first_;
};

}  // namespace

std::size_t exportColmap(const PosedImages& images, const std::vector<PanelMap>& panels,
                         const std::filesystem::path& folder) {
  std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
  std::string shots =
      "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME (world to camera)\n# POINTS2D[] as X Y POINT3D_ID\n";
  CornerPoints points(panels);
  std::map<std::string, std::size_t> camera_ids;  // by all but its number
  for (std::size_t i = 0; i < images.posed.size(); ++i) {
    const PosedImage& posed = images.posed[i];
    const auto [camera, is_new] = camera_ids.try_emplace(lineOf(posed.camera.lens, 0), camera_ids.size() + 1);
    if (is_new) cameras += lineOf(posed.camera.lens, camera->second);
    const Pose T_camera_odom = posed.T_odom_camera().inverse();
    const Eigen::Quaterniond q(T_camera_odom.rotation);
    const Vector3d& t = T_camera_odom.position;
    shots += print("%zu %.12f %.12f %.12f %.12f %.9f %.9f %.9f %zu ", i + 1, q.w(), q.x(), q.y(), q.z(),
                   t.x(), t.y(), t.z(), camera->second) +
             posed.image.file.filename().string() + "\n" + points.seen(posed.detections, i + 1) + "\n";
  }
  writeTextFile(folder / "cameras.txt", cameras);
  writeTextFile(folder / "images.txt", shots);
  writeTextFile(folder / "points3D.txt", points.lines());
  return images.posed.size();
}

}  // namespace fathom
