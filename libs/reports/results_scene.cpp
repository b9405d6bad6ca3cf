#include "reports/results_scene.h"

#include <mrpt/opengl/CEllipsoid3D.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CText3D.h>

#include "core/error.h"
#include "core/files.h"
#include "reports/panel_scene.h"

namespace fathom {
namespace gl = mrpt::opengl;
namespace {

constexpr float kSigmas = 3.0F;
constexpr double kFrustumDepth_m = 0.15;
constexpr float kNameHeight_m = 0.12F;

mrpt::img::TColor colourOf(const NamedPath& path) { return {path.colour[0], path.colour[1], path.colour[2]}; }

void addLine(gl::CSetOfLines& lines, const Vector3d& from, const Vector3d& to) {
  lines.appendLine(from.x(), from.y(), from.z(), to.x(), to.y(), to.z());
}

gl::CSetOfLines::Ptr linesOf(const NamedPath& path) {
  auto lines = gl::CSetOfLines::Create();
  lines->setName(path.name);
  lines->setColor_u8(colourOf(path));
  lines->setLineWidth(2.0F);
  for (std::size_t i = 1; i < path.points.size(); ++i)
    addLine(*lines, path.points[i - 1].T_odom_robot.pose.position, path.points[i].T_odom_robot.pose.position);
  return lines;
}

gl::CEllipsoid3D::Ptr ellipsoidOf(const UncertainPose& T_odom_robot, const mrpt::img::TColor& colour) {
  auto ellipsoid = gl::CEllipsoid3D::Create();
  const Matrix3d covariance = T_odom_robot.covariance.topLeftCorner<3, 3>();
  ellipsoid->setCovMatrix(mrpt::math::CMatrixDouble33(covariance));
  ellipsoid->setQuantiles(kSigmas);
  ellipsoid->enableDrawSolid3D(false);
  ellipsoid->setColor_u8(colour);
  const Vector3d& at = T_odom_robot.pose.position;
  ellipsoid->setLocation(at.x(), at.y(), at.z());
  return ellipsoid;
}

/// One at the first point, then one every so often; none where no covariance is known.
void addEllipsoids(gl::CSetOfObjects& odom, const NamedPath& path, double every_s) {
  double next_s = -std::numeric_limits<double>::infinity();
  for (const auto& [t_s, T_odom_robot] : path.points) {
    // Ellipsoids of metres would hide what they are about.
    constexpr double kLargestSigma_m = 0.5;
    const auto variance = T_odom_robot.covariance.diagonal().head<3>();
    const bool known = variance.minCoeff() > 0 && variance.maxCoeff() < kLargestSigma_m * kLargestSigma_m;
    if (!known || t_s < next_s) continue;
    odom.insert(ellipsoidOf(T_odom_robot, colourOf(path)));
    next_s = t_s + every_s;
  }
}

void addName(gl::CSetOfObjects& odom, const NamedPath& path) {
  if (path.points.empty()) return;
  auto name = gl::CText3D::Create(path.name, "sans", kNameHeight_m, gl::FILL);
  name->setColor_u8(colourOf(path));
  const Vector3d& at = path.points.back().T_odom_robot.pose.position;
  name->setLocation(at.x(), at.y(), at.z());
  odom.insert(name);
}

/// From the optical centre to the image's corners, and around them.
gl::CSetOfLines::Ptr frustaOf(const ResultsScene& results) {
  auto lines = gl::CSetOfLines::Create();
  lines->setName("frusta");
  lines->setColor_u8(mrpt::img::TColor(120, 120, 120));
  const double right = results.camera.width_px - 0.5, bottom = results.camera.height_px - 0.5;
  std::vector<Vector3d> corners_camera;
  for (const Vector2d& pixel :
       {Vector2d(-0.5, -0.5), Vector2d(right, -0.5), Vector2d(right, bottom), Vector2d(-0.5, bottom)})
    corners_camera.emplace_back(kFrustumDepth_m * results.camera.idealAt(pixel).homogeneous());
  for (const Pose& camera : results.T_odom_camera)
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector3d corner = camera * corners_camera[k];
      addLine(*lines, camera.position, corner);
      addLine(*lines, corner, camera * corners_camera[(k + 1) % 4]);
    }
  return lines;
}

}  // namespace

void writeResultsScene(const std::filesystem::path& file, const ResultsScene& results) {
  const gl::CSetOfObjects::Ptr odom = panelsInOdom(results.panels);
  for (const NamedPath& path : results.paths) {
    odom->insert(linesOf(path));
    addEllipsoids(*odom, path, results.ellipsoid_every_s);
    addName(*odom, path);
  }
  odom->insert(frustaOf(results));
  gl::COpenGLScene scene;
  scene.insert(odom);
  PendingFile pending(file);
  if (!scene.saveToFile(pending.path().string())) throw Error(file.string(), "", "cannot be written");
  pending.commit();
}

}  // namespace fathom
