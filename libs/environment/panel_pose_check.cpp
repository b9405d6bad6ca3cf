#include "environment/panel_pose_check.h"

#include <map>

#include "core/evenly.h"
#include "core/for_each.h"
#include "evaluation/recorded_fiducials.h"
#include "imaging/true_panel.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

std::map<fs::path, Pose> truthByImage(const fs::path& rawlog) {
  RawlogReader reader(rawlog);
  std::map<fs::path, Pose> truth;
  for (const RecordedImage& image : recordedImages(reader))
    if (image.T_odom_robot) truth[image.file] = *image.T_odom_robot;
  return truth;
}

/// A posed image whose truth is known: evenly spread ones.
struct TruePose {
  const PosedImage* posed;
  Pose T_panel_camera;
};

std::vector<TruePose> truePoses(const fs::path& rawlog, const std::vector<PosedImage>& posed,
                                const KnownWorld& world, std::size_t count) {
  const PanelMap& panel = world.panels.front();
  const auto truth = truthByImage(rawlog);
  std::vector<TruePose> all;
  for (const PosedImage& image : posed) {
    const auto known = truth.find(image.image.file);
    if (known == truth.end() || image.eye != 0) continue;
    const Pose T_odom_panel = truePanelPose(panel, world.effects, image.t_s);
    all.push_back({&image, T_odom_panel.inverse() * known->second * image.camera.T_robot_camera});
  }
  return evenly(all, count);
}

MeanScore meanError(const std::vector<PanelViewResult>& results, const PanelPoseCheck& check,
                    PanelPoseError PanelViewResult::*method, double PanelPoseError::*measure) {
  std::vector<double> errors;
  const auto counts = [&](const PanelViewResult& result) {
    return (result.*method).exists() && !result.ambiguous;
  };
  for (std::size_t i = 0; i < results.size(); ++i)
    if (counts(check.expected[i]) && counts(check.measured[i])) errors.push_back(results[i].*method.*measure);
  return meanOf(errors);
}

}  // namespace

MeanScore PanelPoseCheck::joint(const std::vector<PanelViewResult>& results,
                                double PanelPoseError::*measure) const {
  return meanError(results, *this, &PanelViewResult::joint, measure);
}

MeanScore PanelPoseCheck::averaged(const std::vector<PanelViewResult>& results,
                                   double PanelPoseError::*measure) const {
  return meanError(results, *this, &PanelViewResult::averaged, measure);
}

bool agree(const MeanScore& a, const MeanScore& b) {
  return std::abs(a.mean - b.mean) <= std::hypot(a.half_width, b.half_width);
}

std::optional<PanelPoseCheck> checkPanelPoses(const fs::path& rawlog, const std::vector<PosedImage>& posed,
                                              const KnownWorld& world, const Environment& water,
                                              const PanelPoseCheckOptions& options) {
  if (world.panels.size() != 1) return std::nullopt;
  const PanelMap& panel = world.panels.front();
  const std::vector<TruePose> poses = truePoses(rawlog, posed, world, options.views);
  if (poses.empty()) return std::nullopt;

  PanelPoseCheck check;
  std::vector<CameraView> views;
  for (const TruePose& pose : poses) {
    views.push_back(viewOf(pose.T_panel_camera));
    views.back().number = views.size();
    views.back().t_s = pose.posed->t_s;
    PanelViewResult& measured = check.measured.emplace_back();
    measured.view = views.back();
    judge(pose.posed->detections, panel, pose.posed->image.camera, pose.T_panel_camera.inverse(), measured);
  }
  Vehicle vehicle = world.vehicle;
  vehicle.camera->model = poses.front().posed->image.camera;
  PanelEvaluationOptions evaluation;
  evaluation.seed = options.seed;
  evaluation.backend = options.backend;
  evaluation.fallback = false;
  evaluation.jpeg_quality = options.jpeg_quality;
  evaluation.effects = world.effects;
  check.expected = evaluatePanel(panel, vehicle, water, evaluation, views, "panel poses in this water");
  return check;
}

}  // namespace fathom
