#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "core/camera_model.h"
#include "panel/surface.h"
#include "render/lighting.h"

/// What a camera would see if there were no water. OSMesa says which triangle each pixel's surroundings see;
/// lens, light and the pixels' edges are computed from the triangles themselves.
namespace fathom {

/// One image without water, noise or quantization.
struct View {
  cv::Mat radiance;  ///< CV_32FC3, linear red, green, blue; 0 where nothing is hit
  cv::Mat range_m;   ///< CV_32FC1, along the line of sight through the pixel's centre; infinity where nothing
                     ///< is hit
};

/// Renders a scene from anywhere with one camera; a stereo pair is two Renderers, or two cameras at once.
///
/// Distortion is exact (to 0.01 px): every pixel has its own line of sight, and range and light are those of
/// the triangle's own plane there. Where triangles meet, a pixel is the mean over its samples; edges lie
/// right to 1/(2 supersampling²) px. A triangle narrower than a pixel can be missed. Triangles nearer than 1
/// cm (along the optical axis) are cut off, both sides of a triangle are seen, and a side turned away from a
/// spot is lit by the ambient light alone.
///
/// Deterministic: the same scene, pose and light give the same bytes, whichever Renderer and thread makes
/// them. Use a Renderer from one thread at a time; to use all cores, one a thread:
///
///     tbb::enumerable_thread_specific<Renderer> renderers([&] { … Renderer with its scene … });
///     tbb::parallel_for(0, count, [&](int i) { views[i] = renderers.local().render(pose(i), lighting); });
///
/// See also visibility.h about Mesa's own threads.
class Renderer {
 public:
  struct Options {
    int supersampling = 5;  ///< its square is the number of samples in a pixel that an edge crosses; 1 to 16
    /// What OSMesa draws at a time, in samples, about three a pixel: larger images are drawn band by
    /// band, which takes no more memory than small ones.
    std::size_t drawn_at_once = std::size_t{1} << 20;
  };
  /// Throws std::runtime_error where OSMesa gives no GL 3.3 context or no image of this size,
  /// std::invalid_argument where the camera has no size or focal length, or a distortion without an inverse
  /// in the image, or supersampling is out of range.
  explicit Renderer(const CameraModel& camera, const Options& options);
  explicit Renderer(const CameraModel& camera) : Renderer(camera, Options{}) {}
  /// Another one of the same camera and options, without a scene: what is computed once for the camera, and
  /// takes most of the memory, they share.
  Renderer another() const;
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Replaces the scene; odom frame. A tenth of a frame's time, so handles can turn between frames. Throws
  /// std::invalid_argument: a triangle without its vertices, or a vertex that is not finite.
  void setScene(Surface surface_odom);
  View render(const Pose& T_odom_camera, const Lighting& lighting);
  /// The same into `view`, whose images are used again where they have the right size.
  void render(const Pose& T_odom_camera, const Lighting& lighting, View& view);

 private:
  struct Implementation;
  explicit Renderer(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace fathom
