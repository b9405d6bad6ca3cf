#include "handles/handle_match.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "render/renderer.h"

namespace fathom {
namespace {

constexpr double kCoarse_rad = radians(7.5), kFine_rad = radians(0.25);
constexpr double kApart_rad = radians(15);     // from which on an angle is another one
constexpr double kCurvature_rad = radians(2);  // to both sides, for the fit's curvature
constexpr double kLeastEvidence =
    50;  // chi-square: a handle that hardly differs from the panel shows nothing
constexpr double kMostMisfit = 0.35;
constexpr double kLeastSupport = 4;  // ln
// What a tenth of the pixels is off by, over what half of them are, by the same of normal noise: beyond it,
// something is in front of the panel.
constexpr double kLongestTail = 2.5;
constexpr std::size_t kFewestBeyond = 100;
constexpr int kRobustRounds = 8;
constexpr double kResampled = 2;  // neighbouring pixels of a close-up share their noise

/// The map's surface without handles, panel frame.
Surface bareSurface(PanelMap map) {
  map.handles.clear();
  return surfaceOf(map);
}

/// Sigma of each pixel's radiance, CV_32FC3: the sensor's noise and its rounding.
cv::Mat noiseOf(const cv::Mat& light, const CameraSheet& sheet) {
  cv::Mat sigma(light.size(), CV_32FC3);
  for (int row = 0; row < light.rows; ++row)
    for (int column = 0; column < light.cols; ++column)
      for (int c = 0; c < 3; ++c)
        sigma.at<cv::Vec3f>(row, column)[c] =
            static_cast<float>(pixelSigma(std::max(0.0F, light.at<cv::Vec3f>(row, column)[c]), sheet));
  return sigma;
}

/// seen = gain * simulated + veil by weighted least squares; no handle is brighter in the dark.
struct LightFit {
  double gain = 0, veil = 0, chi_square = 0;
  double at(double simulated) const { return gain * simulated + veil; }
};

struct Compared {
  double seen, weight;
  int row, column;
};

LightFit fitLight(const std::vector<Compared>& pixels, const cv::Mat& simulated, int channel) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (const Compared& p : pixels) {
    const double s = simulated.at<cv::Vec3f>(p.row, p.column)[channel];
    n += p.weight;
    x += p.weight * s;
    y += p.weight * p.seen;
    xx += p.weight * s * s;
    xy += p.weight * s * p.seen;
    yy += p.weight * p.seen * p.seen;
  }
  const double sxx = xx - x * x / n, sxy = xy - x * y / n, syy = yy - y * y / n;
  LightFit fit;
  fit.gain = sxx > 0 ? std::max(0.0, sxy / sxx) : 0;
  fit.veil = (y - fit.gain * x) / n;
  fit.chi_square = syy - 2 * fit.gain * sxy + fit.gain * fit.gain * sxx;
  return fit;
}

/// By least absolute differences: something in front of a part of the panel does not count.
LightFit fitLightRobustly(const std::vector<Compared>& pixels, const cv::Mat& simulated, int channel) {
  std::vector<Compared> reweighted = pixels;
  LightFit fit;
  for (int round = 0; round < kRobustRounds; ++round) {
    fit = fitLight(reweighted, simulated, channel);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Compared& p = pixels[i];
      const double off = p.seen - fit.at(simulated.at<cv::Vec3f>(p.row, p.column)[channel]);
      reweighted[i].weight = p.weight / std::max(1.0, std::abs(off) * std::sqrt(p.weight));
    }
  }
  return fit;
}

}  // namespace

struct HandleMatcher::Implementation {
  HandleScene scene;
  Surface bare;
  /// One for each size of a close-up, with how it turns radiance into light.
  struct Studio {
    Renderer renderer;
    ImageModel model;
  };
  std::map<std::pair<int, double>, Studio> studios;

  Studio& studioOf(const CameraModel& camera) {
    const std::pair key(camera.width_px, camera.fx_px);
    auto it = studios.find(key);
    if (it == studios.end()) {
      CameraSheet sheet = scene.sheet;
      sheet.model = camera;
      it = studios.emplace(key, Studio{Renderer(camera), ImageModel(sheet, scene.environment.water)}).first;
    }
    return it->second;
  }

  /// The light that would come from the panel with the handle turned so; without `angle`, from the panel
  /// alone.
  cv::Mat lightOf(Studio& studio, const CloseUp& close, const Handle& handle,
                  std::optional<double> angle_rad) {
    Surface surface = bare;
    if (angle_rad) {
      Handle turned = handle;
      turned.angle_rad = *angle_rad;
      surface.add(surfaceOf(turned), turned.T_panel_handle());
    }
    studio.renderer.setScene(std::move(surface));
    const View view =
        studio.renderer.render(close.T_panel_camera, {scene.environment.ambient.cast<float>(), {}});
    return studio.model.light(view.radiance, view.range_m);
  }
};

HandleMatcher::HandleMatcher(HandleScene scene) : implementation_(std::make_unique<Implementation>()) {
  implementation_->bare = bareSurface(scene.map);
  implementation_->scene = std::move(scene);
}
HandleMatcher::~HandleMatcher() = default;
HandleMatcher::HandleMatcher(HandleMatcher&&) noexcept = default;

namespace {

double quantileOf(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// A search over the handle's range for the angle whose rendering fits best.
class AngleSearch {
 public:
  /// `bare`: the panel as it would be seen without the handle.
  AngleSearch(const CloseUp& close, const CameraSheet& sheet, const cv::Mat& bare) {
    const cv::Mat sigma = noiseOf(close.light, sheet);
    for (int row = 0; row < close.light.rows; ++row)
      for (int column = 0; column < close.light.cols; ++column)
        for (std::size_t c = 0; c < 3; ++c) {
          const int channel = static_cast<int>(c);
          (close.in_reach.at<uchar>(row, column) != 0 ? within_ : beyond_)[c].push_back(
              {close.light.at<cv::Vec3f>(row, column)[channel],
               1 / std::pow(sigma.at<cv::Vec3f>(row, column)[channel], 2), row, column});
        }
    for (std::size_t c = 0; c < 3; ++c) {
      const double variance = varianceBeyond(bare, static_cast<int>(c));
      for (Compared& p : within_[c]) p.weight /= variance;
    }
  }

  double chiSquare(const cv::Mat& simulated) const {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
      sum += fitLight(within_[c], simulated, static_cast<int>(c)).chi_square;
    return sum;
  }
  cv::Mat inLight(const cv::Mat& simulated) const {
    cv::Mat lit(simulated.size(), CV_32FC3);
    std::array<LightFit, 3> fits;
    for (std::size_t c = 0; c < 3; ++c) fits[c] = fitLight(within_[c], simulated, static_cast<int>(c));
    lit.forEach<cv::Vec3f>([&](cv::Vec3f& value, const int* at) {
      for (int c = 0; c < 3; ++c)
        value[c] = static_cast<float>(
            fits[static_cast<std::size_t>(c)].at(simulated.at<cv::Vec3f>(at[0], at[1])[c]));
    });
    return lit;
  }
  double count() const { return 3.0 * static_cast<double>(within_[0].size()); }

 private:
  /// How many times the sensor's variance what is beyond the handle's reach differs by from a rendering in
  /// the light there: what JPEG leaves, of some channels more than of others, and a lens. As little as 1.
  double varianceBeyond(const cv::Mat& simulated, int channel) const {
    const std::vector<Compared>& beyond = beyond_[static_cast<std::size_t>(channel)];
    if (beyond.size() < kFewestBeyond) return 1;
    const LightFit fit = fitLightRobustly(beyond, simulated, channel);
    std::vector<double> sizes;
    for (const Compared& p : beyond)
      sizes.push_back(std::abs(p.seen - fit.at(simulated.at<cv::Vec3f>(p.row, p.column)[channel])) *
                      std::sqrt(p.weight));
    const double most = quantileOf(sizes, 0.9) / 1.645, half = quantileOf(sizes, 0.5) / 0.6745;
    const double sigma = std::min(most, kLongestTail * half);
    return std::max(1.0, sigma * sigma);
  }

  std::array<std::vector<Compared>, 3> within_, beyond_;  // the handle's reach; by channel
};

}  // namespace

HandleMatch HandleMatcher::match(const PosedPanelImage& image, std::size_t index) {
  const Handle& handle = implementation_->scene.map.handles.at(index);
  const CloseUp close = closeUpOf(image, handle);
  Implementation::Studio& studio = implementation_->studioOf(close.camera);
  const cv::Mat panel = implementation_->lightOf(studio, close, handle, {});
  const AngleSearch search(close, implementation_->scene.sheet, panel);
  std::map<double, double> tried;
  const auto chiSquare = [&](double angle_rad) {
    const auto [it, is_new] = tried.try_emplace(angle_rad, 0);
    if (is_new) it->second = search.chiSquare(implementation_->lightOf(studio, close, handle, angle_rad));
    return it->second;
  };

  const double symmetry = symmetryOf(handle.kind);
  const double range = std::min(handle.largest_angle_rad - handle.smallest_angle_rad, symmetry);
  const int steps = std::max(1, static_cast<int>(std::ceil(range / kCoarse_rad)));
  double best = handle.smallest_angle_rad;
  for (int i = 0; i <= steps; ++i) {
    const double angle = handle.smallest_angle_rad + range * i / steps;
    if (chiSquare(angle) < chiSquare(best)) best = angle;
  }
  for (double step = kCoarse_rad / 2; step > kFine_rad / 2; step /= 2)
    for (const double next : {best - step, best + step})
      if (chiSquare(next) < chiSquare(best)) best = next;

  HandleMatch match;
  match.angle_rad = best;
  match.seen = close.light;
  match.in_reach = close.in_reach;
  match.simulated = search.inLight(implementation_->lightOf(studio, close, handle, best));
  const double least = chiSquare(best);
  const double bare = search.chiSquare(panel);
  // What is left beyond noise is as large everywhere.
  const double scale = kResampled * std::max(1.0, least / search.count());
  const double curvature = (chiSquare(best - kCurvature_rad) + chiSquare(best + kCurvature_rad) - 2 * least) /
                           (kCurvature_rad * kCurvature_rad);
  double other = std::numeric_limits<double>::infinity();
  for (const auto& [angle, chi_square] : tried) {
    match.fits.push_back({angle, chi_square});
    if (std::abs(angleDifference(angle, best, symmetry)) > kApart_rad) other = std::min(other, chi_square);
  }
  match.evidence = (bare - least) / scale;
  match.misfit = std::max(0.0, least - search.count()) / std::max(1e-9, bare - least);
  match.support = 0.5 * (other - least) / scale;
  match.sigma_rad = curvature > 0 ? std::sqrt(2 * scale / curvature) : std::numbers::pi;
  if (match.evidence < kLeastEvidence)
    match.why_not = "the image does not show it";
  else if (match.misfit > kMostMisfit)
    match.why_not = "what is there is not the handle as the map has it";
  else if (match.support < kLeastSupport)
    match.why_not = "another angle fits as well";
  match.found = match.why_not.empty();
  return match;
}

}  // namespace fathom
