#include "calibration/camera_fit.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <stdexcept>

#include "core/median.h"

namespace fathom {
namespace {

constexpr std::size_t kFewestViews = 3, kFewestPoints = 6;
constexpr double kOutlierSigmas = 5;  // by chance one in a million
constexpr int kRounds = 4;  // of leaving outliers out; the first knows no sigma, by which priors count
constexpr double kMedianOfRayleigh = 1.1774;  // of a point's distance, in sigmas of a coordinate

using PoseValues = std::array<double, 6>;  ///< rotation vector, position

PoseValues valuesOf(const Pose& pose) {
  const Vector3d r = logSO3<double>(pose.rotation);
  return {r.x(), r.y(), r.z(), pose.position.x(), pose.position.y(), pose.position.z()};
}
Pose poseOf(const PoseValues& v) { return {expSO3<double>(Vector3d(v[0], v[1], v[2])), {v[3], v[4], v[5]}}; }

/// What the points of a view are off by, px. Parameters: cameraUnknowns(), PoseValues.
struct Reprojection {
  const BoardView& view;
  const CameraKind& kind;
  const CameraSetting& setting;
  std::vector<std::size_t> used;

  template <class T>
  bool operator()(const T* camera, const T* pose, T* off) const {
    const CameraProjector<T> projector = projectorOf(camera, kind, setting, view.in_water);
    const Matrix3<T> R = expSO3<T>(Vector3<T>(pose[0], pose[1], pose[2]));
    const Vector3<T> position(pose[3], pose[4], pose[5]);
    for (const std::size_t i : used) {
      const Vector3<T> point = R * view.points_m[i].cast<T>() + position;
      if (!(point.z() > 1e-3)) return false;
      const Vector2<T> pixel = projector.project(point);
      *off++ = pixel.x() - view.pixels[i].x();
      *off++ = pixel.y() - view.pixels[i].y();
    }
    return true;
  }
};

ceres::CostFunction* costOf(const BoardView& view, const CameraKind& kind, const CameraSetting& setting,
                            const std::vector<std::size_t>& used) {
  return new ceres::AutoDiffCostFunction<Reprojection, ceres::DYNAMIC, kCameraUnknowns, 6>(
      new Reprojection{view, kind, setting, used}, static_cast<int>(2 * used.size()));
}

/// What is known of a camera's numbers before.
struct Prior {
  std::vector<std::size_t> places;  ///< of those that have one

  template <class T>
  bool operator()(const T* camera, T* off) const {
    for (const std::size_t place : places) *off++ = camera[place] / cameraUnknowns()[place].prior_sigma;
    return true;
  }
};

std::vector<std::size_t> allOf(const BoardView& view) {
  std::vector<std::size_t> all(view.pixels.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

/// How far each point lies off.
std::vector<double> distancesOf(const CameraFit& fit, const BoardView& view, const Pose& T_camera_board) {
  const CameraProjector<double> projector = fit.projector(view.in_water);
  std::vector<double> off;
  for (std::size_t i = 0; i < view.pixels.size(); ++i)
    off.push_back((projector.project(Vector3d(T_camera_board * view.points_m[i])) - view.pixels[i]).norm());
  return off;
}

using Jacobian = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// What one view tells of the camera once its pose is solved for.
struct Told {
  Eigen::MatrixXd information;
  Eigen::VectorXd score;
  double squares = 0;  ///< of its residuals
};
Told toldOf(Eigen::MatrixXd by_camera, const Eigen::MatrixXd& by_pose, const Eigen::VectorXd& off) {
  by_camera -= by_pose * by_pose.colPivHouseholderQr().solve(by_camera);
  return {by_camera.transpose() * by_camera, by_camera.transpose() * off, off.squaredNorm()};
}

/// By how the camera would change without each view (jackknife to first order; Bell & McCaffrey 2002, CR3),
/// since what a view's points are off by they have in common. What is known beforehand, `prior`, is known as
/// well without a view. Few views cannot tell how they differ: then by points that are off each by itself.
Eigen::MatrixXd covarianceOf(const std::vector<Told>& views, const Eigen::MatrixXd& prior, double sigma_px) {
  Eigen::MatrixXd all = prior;
  for (const Told& view : views) all += view.information;
  const Eigen::MatrixXd inverse = all.inverse();
  Eigen::MatrixXd covariance = sigma_px * sigma_px * inverse * prior * inverse;
  if (std::ssize(views) <= all.rows()) return sigma_px * sigma_px * inverse;
  const auto count = static_cast<double>(views.size());
  for (const Told& view : views) {
    const Eigen::VectorXd change = (all - view.information).ldlt().solve(view.score);
    covariance += (count - 1) / count * change * change.transpose();
  }
  return covariance;
}

/// The bundle: one camera, a pose for each view, those points that are used.
class Bundle {
 public:
  Bundle(const std::vector<BoardView>& views, CameraFit start) : views_(views), fit_(std::move(start)) {
    for (const BoardView& view : views_) used_.push_back(allOf(view));
  }

  CameraFit solve() {
    for (int round = 0; round < kRounds; ++round) {
      solveOnce();
      if (!leaveOutliersOut() && round > 0) break;
    }
    return fit_;
  }

 private:
  void solveOnce() {
    std::vector<PoseValues> poses;
    for (const BoardView& view : views_) poses.push_back(valuesOf(fit_.T_camera_board.at(view.name)));
    ceres::Problem problem;
    for (std::size_t i = 0; i < views_.size(); ++i)
      problem.AddResidualBlock(costOf(views_[i], *fit_.kind, fit_.setting, used_[i]), nullptr,
                               fit_.values.data(), poses[i].data());
    const std::vector<std::size_t> known = placesWithPrior();
    auto* prior = new ceres::AutoDiffCostFunction<Prior, ceres::DYNAMIC, kCameraUnknowns>(
        new Prior{known}, static_cast<int>(known.size()));
    problem.AddResidualBlock(prior, new ceres::ScaledLoss(nullptr, priorWeight(), ceres::TAKE_OWNERSHIP),
                             fit_.values.data());
    problem.SetManifold(fit_.values.data(), new ceres::SubsetManifold(kCameraUnknowns, held()));
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-12;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    for (std::size_t i = 0; i < views_.size(); ++i) fit_.T_camera_board[views_[i].name] = poseOf(poses[i]);
    note(problem, poses);
  }

  void note(ceres::Problem& problem, std::vector<PoseValues>& poses) {
    std::vector<double*> blocks{fit_.values.data()};
    for (PoseValues& pose : poses) blocks.push_back(pose.data());
    ceres::Problem::EvaluateOptions what;
    what.parameter_blocks = blocks;
    std::vector<double> residuals;
    ceres::CRSMatrix crs;
    problem.Evaluate(what, nullptr, &residuals, nullptr, &crs);
    const Jacobian J = Eigen::Map<const Jacobian>(crs.num_rows, crs.num_cols, std::ssize(crs.values),
                                                  crs.rows.data(), crs.cols.data(), crs.values.data());
    const Eigen::Index unknowns = std::ssize(fit_.unknowns);
    std::vector<Told> told;
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const Eigen::Index rows = 2 * std::ssize(used_[i]), pose = unknowns + 6 * static_cast<Eigen::Index>(i);
      const Eigen::MatrixXd own(J.middleRows(row, rows));
      told.push_back(toldOf(own.leftCols(unknowns), own.middleCols(pose, 6),
                            Eigen::Map<const Eigen::VectorXd>(residuals.data() + row, rows)));
      row += rows;
    }
    double squares = 0;
    for (const Told& one : told) squares += one.squares;
    fit_.points = static_cast<std::size_t>(row / 2);
    fit_.sigma_px = std::sqrt(squares / std::max<double>(1, static_cast<double>(row - J.cols())));
    fit_.rms_px = std::sqrt(2 * squares / static_cast<double>(row));
    const Eigen::MatrixXd prior = Eigen::MatrixXd(J.bottomRows(J.rows() - row)).leftCols(unknowns);
    fit_.covariance = covarianceOf(told, prior.transpose() * prior, fit_.sigma_px);
  }

  /// A prior counts as what is known, points by how far they scatter.
  double priorWeight() const { return fit_.sigma_px > 0 ? fit_.sigma_px * fit_.sigma_px : 1e-2; }

  std::vector<std::size_t> placesWithPrior() const {
    std::vector<std::size_t> known;
    for (const std::size_t place : fit_.unknowns)
      if (cameraUnknowns()[place].prior_sigma > 0) known.push_back(place);
    return known;
  }

  std::vector<int> held() const {
    std::vector<int> places;
    for (std::size_t place = 0; place < kCameraUnknowns; ++place)
      if (std::find(fit_.unknowns.begin(), fit_.unknowns.end(), place) == fit_.unknowns.end())
        places.push_back(static_cast<int>(place));
    return places;
  }

  /// Whether any point is used now that was not, or the other way round.
  bool leaveOutliersOut() {
    std::vector<std::vector<double>> off;
    std::vector<double> all;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      off.push_back(distancesOf(fit_, views_[i], fit_.T_camera_board.at(views_[i].name)));
      all.insert(all.end(), off.back().begin(), off.back().end());
    }
    const double limit_px = kOutlierSigmas * upperMedian(all) / kMedianOfRayleigh;
    const auto before = used_;
    fit_.outliers = 0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      used_[i].clear();
      for (std::size_t k = 0; k < off[i].size(); ++k)
        if (off[i][k] <= limit_px) used_[i].push_back(k);
      if (used_[i].size() < kFewestPoints) used_[i] = allOf(views_[i]);
      fit_.outliers += off[i].size() - used_[i].size();
    }
    return used_ != before;
  }

  const std::vector<BoardView>& views_;
  CameraFit fit_;
  std::vector<std::vector<std::size_t>> used_;
};

struct CvPoints {
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
};
CvPoints forOpenCv(const std::vector<BoardView>& views) {
  CvPoints all;
  for (const BoardView& view : views) {
    auto& points = all.points.emplace_back();
    auto& pixels = all.pixels.emplace_back();
    for (const Vector3d& p : view.points_m)
      points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
    for (const Vector2d& p : view.pixels)
      pixels.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return all;
}

Pose poseOf(const cv::Mat& turn, const cv::Mat& shift) {
  const auto at = [](const cv::Mat& m) {
    return Vector3d(m.at<double>(0), m.at<double>(1), m.at<double>(2));
  };
  return {expSO3<double>(at(turn)), at(shift)};
}

std::vector<BoardView> viewsIn(bool water, const std::vector<BoardView>& views) {
  std::vector<BoardView> own;
  std::copy_if(views.begin(), views.end(), std::back_inserter(own),
               [&](const BoardView& view) { return view.in_water == water; });
  return own;
}

void check(const std::vector<BoardView>& views) {
  if (views.size() < kFewestViews)
    throw std::invalid_argument("a camera is calibrated from three views or more");
  for (const BoardView& view : views)
    if (view.pixels.size() < kFewestPoints)
      throw std::invalid_argument("view " + view.name + " has fewer than six points");
}

}  // namespace

BoardView BoardView::half(std::size_t from) const {
  BoardView own{name, {}, {}, in_water};
  for (std::size_t i = from; i < pixels.size(); i += 2) {
    own.points_m.push_back(points_m[i]);
    own.pixels.push_back(pixels[i]);
  }
  return own;
}

double CameraFit::sigmaOf(std::size_t unknown) const {
  const auto found = std::find(unknowns.begin(), unknowns.end(), unknown);
  const auto k = found - unknowns.begin();
  return found == unknowns.end() ? 0 : std::sqrt(covariance(k, k));
}

CameraFit fitByOpenCv(const std::vector<BoardView>& views, const CameraSetting& setting) {
  check(views);
  const CvPoints given = forOpenCv(views);
  cv::Mat K, distortion, sigmas, unused_sigmas, unused_errors;
  std::vector<cv::Mat> turns, shifts;
  CameraFit fit;
  fit.kind = findCameraKind("pinhole");
  fit.setting = setting;
  fit.rms_px = cv::calibrateCamera(given.points, given.pixels, {setting.width_px, setting.height_px}, K,
                                   distortion, turns, shifts, sigmas, unused_sigmas, unused_errors);
  fit.values.head<9>() << K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2), K.at<double>(1, 2),
      distortion.at<double>(0), distortion.at<double>(1), distortion.at<double>(2), distortion.at<double>(3),
      distortion.at<double>(4);
  fit.unknowns = unknownsOf(*fit.kind, false);
  fit.covariance = Eigen::MatrixXd::Zero(std::ssize(fit.unknowns), std::ssize(fit.unknowns));
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    fit.covariance(i, i) = std::pow(sigmas.at<double>(static_cast<int>(k)), 2);
  }
  for (std::size_t i = 0; i < turns.size(); ++i)
    fit.T_camera_board[views[i].name] = poseOf(turns[i], shifts[i]);
  for (const BoardView& view : views) fit.points += view.pixels.size();
  return fit;
}

Pose poseOfView(const CameraFit& camera, const BoardView& view) {
  const CvPoints given = forOpenCv({view});
  const cv::Mat K = (cv::Mat_<double>(3, 3) << camera.values[0], 0, camera.values[2], 0, camera.values[1],
                     camera.values[3], 0, 0, 1);
  cv::Mat turn, shift;
  cv::solvePnP(given.points[0], given.pixels[0], K, {}, turn, shift);
  PoseValues pose = valuesOf(poseOf(turn, shift));
  CameraValues values = camera.values;
  ceres::Problem problem;
  problem.AddResidualBlock(costOf(view, *camera.kind, camera.setting, allOf(view)), nullptr, values.data(),
                           pose.data());
  problem.SetParameterBlockConstant(values.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return poseOf(pose);
}

CameraFit fitCamera(const std::vector<BoardView>& views, const CameraKind& kind, const CameraSetting& setting,
                    const std::optional<CameraFit>& start) {
  check(views);
  const auto air = viewsIn(false, views);
  const bool has_air = air.size() >= kFewestViews, has_water = air.size() < views.size();
  CameraFit from = start ? *start : fitByOpenCv(has_air ? air : views, setting);
  if (from.kind->lens != kind.lens) from.values.segment<8>(4).setZero();
  // Seen through a flat port, what is in water looks nearer by the index.
  const bool was_in_water = !has_air && from.kind->port != CameraKind::Port::flat;
  if (was_in_water && kind.port == CameraKind::Port::flat) from.values.head<2>() /= kWaterIndex;
  from.kind = &kind;
  from.setting = setting;
  from.unknowns = unknownsOf(kind, has_water);
  from.sigma_px = 0;
  const std::map<std::string, Pose> before = std::move(from.T_camera_board);
  from.T_camera_board.clear();
  for (const BoardView& view : views) {
    const auto known = before.find(view.name);
    from.T_camera_board[view.name] = known == before.end() ? poseOfView(from, view) : known->second;
  }
  return Bundle(views, from).solve();
}

}  // namespace fathom
