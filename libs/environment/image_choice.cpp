#include "environment/image_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/evenly.h"

namespace fathom {
namespace {

constexpr std::size_t kShortestStretch = 5;
// Of the features below, so that range counts most: it is what tells attenuation.
constexpr double kRangeWeight = 3, kPlaceWeight = 0.5;

using Features = Eigen::Matrix<double, 5, 1>;

bool isCertain(const PosedImage& image, const std::vector<PanelMap>& panels, double largest_share) {
  const double variance = image.T_odom_robot.covariance.topLeftCorner<3, 3>().trace();
  return std::sqrt(variance) <= largest_share * range_m(image, panels);
}

/// Logarithm of the range, direction to the camera from the panel, the panel's place in the image.
Features featuresOf(const PosedImage& image, const std::vector<PanelMap>& panels) {
  const Pose& T_odom_panel = panels[image.panel].T_odom_panel;
  const Vector3d camera_panel = T_odom_panel.inverse() * image.T_odom_camera().position;
  const Vector3d panel_camera = image.T_odom_camera().inverse() * T_odom_panel.position;
  Features features;
  features << kRangeWeight * std::log(camera_panel.norm()), camera_panel.head<2>() / camera_panel.norm(),
      kPlaceWeight * panel_camera.head<2>() / panel_camera.norm();
  return features;
}

/// So many of the candidates, each the farthest from all before; see chooseImages().
std::vector<std::size_t> farApart(const std::vector<std::size_t>& candidates, std::size_t count,
                                  const std::vector<PosedImage>& posed, const std::vector<PanelMap>& panels) {
  std::vector<Features> features;
  for (const std::size_t i : candidates) features.push_back(featuresOf(posed[i], panels));
  std::vector<double> distance(candidates.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> chosen;
  auto next = std::min_element(features.begin(), features.end(),
                               [](const auto& a, const auto& b) { return a[0] < b[0]; }) -
              features.begin();
  while (chosen.size() < std::min(count, candidates.size())) {
    const auto taken = static_cast<std::size_t>(next);
    chosen.push_back(candidates[taken]);
    for (std::size_t i = 0; i < distance.size(); ++i)
      distance[i] = std::min(distance[i], (features[i] - features[taken]).norm());
    distance[taken] = -1;
    next = std::max_element(distance.begin(), distance.end()) - distance.begin();
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

ImageChoice chooseImages(const std::vector<PosedImage>& posed, const std::vector<PanelMap>& panels,
                         const ImageChoiceOptions& options) {
  ImageChoice choice;
  std::vector<std::size_t> certain, to_fit, to_judge;
  for (std::size_t i = 0; i < posed.size(); ++i)
    if (isCertain(posed[i], panels, options.largest_position_sigma))
      certain.push_back(i);
    else
      ++choice.too_uncertain;
  const std::size_t stretches =
      std::clamp<std::size_t>(certain.size() / kShortestStretch, 1, options.stretches);
  for (std::size_t k = 0; k < certain.size(); ++k) {
    const std::size_t stretch = k * stretches / certain.size();
    const bool held_out = stretch % options.held_out_every == options.held_out_every / 2;
    (held_out ? to_judge : to_fit).push_back(certain[k]);
  }
  choice.fitted = farApart(to_fit, options.images, posed, panels);
  choice.held_out = evenly(to_judge, options.held_out);
  return choice;
}

}  // namespace fathom
