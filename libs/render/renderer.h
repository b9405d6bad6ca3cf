#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "core/camera_model.h"
#include "panel/surface.h"

/// What a camera would see if there were no water: OSMesa, GL 3.3 core, one context a Renderer.
namespace fathom {

/// A spot light: uniform inside its cone, falling with the square of the distance.
struct Spot {
  Pose T_odom_lamp;  ///< light leaves along x
  double half_angle_rad = 0;
  Eigen::Vector3f irradiance_1m{1.0f, 1.0f, 1.0f};  ///< on the axis at 1 m, in units of full ambient light
};

/// Light at the scene. A matt surface of albedo A has radiance A * (ambient + sum over spots of irradiance *
/// cos(incidence)): a white of albedo 0.85 under ambient light 1 has 0.85, and 1 is the camera's full scale.
struct Lighting {
  Eigen::Vector3f ambient{1.0f, 1.0f, 1.0f};
  std::vector<Spot> spots;
};

/// One image without water, noise or quantization.
struct View {
  cv::Mat radiance;  ///< CV_32FC3, linear red, green, blue; 0 where nothing is hit
  cv::Mat range_m;   ///< CV_32FC1, along the line of sight through the pixel's centre; infinity where nothing
                     ///< is hit
};

class Renderer {
 public:
  struct Options {
    int supersampling = 4;  ///< samples along each side of a pixel
  };
  /// Throws std::runtime_error where OSMesa gives no GL 3.3 context.
  explicit Renderer(const CameraModel& camera, const Options& options);
  explicit Renderer(const CameraModel& camera) : Renderer(camera, Options{}) {}
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Replaces the scene; odom frame.
  void setScene(const Surface& surface_odom);
  View render(const Pose& T_odom_camera, const Lighting& lighting);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace fathom
