#include "core/camera_model.h"

#include <ceres/jet.h>

#include <algorithm>
#include <array>

#include "core/text.h"

namespace fathom {
namespace {

constexpr std::array kLensNames{"plumb_bob", "rational", "fisheye"};  // in the order of LensModel
constexpr std::array kRational{
    LensCoefficient{"k1", &CameraModel::k1}, LensCoefficient{"k2", &CameraModel::k2},
    LensCoefficient{"p1", &CameraModel::p1}, LensCoefficient{"p2", &CameraModel::p2},
    LensCoefficient{"k3", &CameraModel::k3}, LensCoefficient{"k4", &CameraModel::k4},
    LensCoefficient{"k5", &CameraModel::k5}, LensCoefficient{"k6", &CameraModel::k6}};
constexpr std::array kFisheye{
    LensCoefficient{"k1", &CameraModel::k1}, LensCoefficient{"k2", &CameraModel::k2},
    LensCoefficient{"k3", &CameraModel::k3}, LensCoefficient{"k4", &CameraModel::k4}};

}  // namespace

std::span<const LensCoefficient> coefficientsOf(LensModel lens) {
  if (lens == LensModel::fisheye) return kFisheye;
  const std::span<const LensCoefficient> all(kRational);
  return lens == LensModel::rational ? all : all.first(5);
}

std::string_view nameOf(LensModel lens) { return kLensNames[static_cast<std::size_t>(lens)]; }

std::optional<LensModel> lensNamed(std::string_view name) {
  const auto found = std::find(kLensNames.begin(), kLensNames.end(), name);
  if (found == kLensNames.end()) return {};
  return static_cast<LensModel>(found - kLensNames.begin());
}

int colourAt(BayerPattern pattern, int column, int row) {
  constexpr int kRed = 0, kGreen = 1, kBlue = 2;
  constexpr std::array<std::array<int, 4>, 4> kColours{{{kRed, kGreen, kGreen, kBlue},
                                                        {kGreen, kRed, kBlue, kGreen},
                                                        {kGreen, kBlue, kRed, kGreen},
                                                        {kBlue, kGreen, kGreen, kRed}}};
  if (pattern == BayerPattern::none) return -1;
  const auto one = static_cast<std::size_t>(pattern) - 1;
  return kColours[one][static_cast<std::size_t>(2 * (row % 2) + column % 2)];
}

double pixelsPerMeasured(BayerPattern pattern, int colour) {
  if (pattern == BayerPattern::none) return 1;
  constexpr int kGreen = 1;
  return colour == kGreen ? 2 : 4;
}

std::optional<BayerPattern> bayerNamed(std::string_view name) {
  constexpr std::array<std::string_view, 4> kNames{"rggb", "grbg", "gbrg", "bggr"};
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return {};
  return static_cast<BayerPattern>(found - kNames.begin() + 1);
}

std::string distortionText(const CameraModel& camera) {
  std::string text = camera.lens == LensModel::plumb_bob ? "" : "model: " + std::string(nameOf(camera.lens));
  for (const LensCoefficient& c : coefficientsOf(camera.lens))
    text += (text.empty() ? "" : ", ") + print("%s: %.9g", c.name, camera.*c.value);
  return text;
}

Vector2d CameraModel::idealAt(const Vector2d& pixel) const {
  using Jet = ceres::Jet<double, 2>;
  const Vector2d distorted((pixel.x() - cx_px) / fx_px, (pixel.y() - cy_px) / fy_px);
  Vector2d ideal = distorted;
  for (int i = 0; i < 50; ++i) {
    const Vector2<Jet> d = distort(Vector2<Jet>(Jet(ideal.x(), 0), Jet(ideal.y(), 1)));
    Eigen::Matrix2d J;
    J << d.x().v.transpose(), d.y().v.transpose();
    const Vector2d step = J.inverse() * (distorted - Vector2d(d.x().a, d.y().a));
    ideal += step;
    if (step.squaredNorm() < 1e-26) break;
  }
  return ideal;
}

}  // namespace fathom
