#include "calibration/projection.h"

#include <ceres/jet.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/parallel.h"

namespace fathom {
namespace {

constexpr int kColumns = 9, kRows = 7;
constexpr int kDraws = 100;  // sigma to 7 %
constexpr int kMostSteps = 10;
constexpr double kConverged_px = 1e-7;

using Jet = ceres::Jet<double, 6>;

/// In the first camera's frame.
std::vector<Vector3d> pointsOn(const ProjectionGrid& grid, const CameraFit& camera) {
  const CameraProjector<double> projector = camera.projector(grid.in_water);
  std::vector<Vector3d> points;
  for (const Vector2d& pixel : grid.pixels) {
    const SightLine<double> line = projector.lineOfSight(pixel);
    points.emplace_back(line.origin + grid.range_m * line.direction);
  }
  return points;
}

}  // namespace

ProjectionGrid gridOver(const CameraSetting& setting, double range_m, bool in_water) {
  ProjectionGrid grid{{}, kColumns, kRows, range_m, in_water};
  const auto at = [](int i, int count, int size_px) { return (i + 0.5) * size_px / count - 0.5; };
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column)
      grid.pixels.emplace_back(at(column, kColumns, setting.width_px), at(row, kRows, setting.height_px));
  return grid;
}

std::vector<Vector2d> projectionDifference(const CameraFit& camera, const CameraFit& other,
                                           const ProjectionGrid& grid) {
  const std::vector<Vector3d> points = pointsOn(grid, camera);
  const CameraProjector<double> projector = other.projector(grid.in_water);
  Pose T_other_camera;
  std::vector<Vector2d> off(points.size());
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3<Jet> turn(Jet(0, 0), Jet(0, 1), Jet(0, 2)), shift(Jet(0, 3), Jet(0, 4), Jet(0, 5));
      const Vector3d there = T_other_camera * points[i];
      const Vector2<Jet> pixel =
          projector.project(Vector3<Jet>(expSO3<Jet>(turn) * there.cast<Jet>() + shift));
      for (int k = 0; k < 2; ++k) {
        off[i][k] = pixel[k].a - grid.pixels[i][k];
        information += pixel[k].v * pixel[k].v.transpose();
        gradient += off[i][k] * pixel[k].v;
      }
    }
    const Eigen::Matrix<double, 6, 1> move = information.ldlt().solve(-gradient);
    T_other_camera = Pose{expSO3<double>(move.head<3>()), move.tail<3>()} * T_other_camera;
    if (std::sqrt(move.dot(information * move)) < kConverged_px) break;
  }
  return off;
}

std::vector<double> projectionSigma(const CameraFit& camera, const ProjectionGrid& grid, Random& random) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(camera.covariance);
  const Eigen::MatrixXd root =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd draws = root * random.normals(root.cols(), kDraws);
  std::vector<std::vector<Vector2d>> off(kDraws);
  parallelFor(kDraws, [&](int k) {
    CameraFit drawn = camera;
    for (std::size_t i = 0; i < camera.unknowns.size(); ++i)
      drawn.values[static_cast<Eigen::Index>(camera.unknowns[i])] += draws(static_cast<Eigen::Index>(i), k);
    off[static_cast<std::size_t>(k)] = projectionDifference(camera, drawn, grid);
  });
  std::vector<double> sigma(grid.pixels.size());
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    double squares = 0;
    for (const auto& one : off) squares += one[i].squaredNorm();
    sigma[i] = std::sqrt(squares / (2 * kDraws));
  }
  return sigma;
}

}  // namespace fathom
