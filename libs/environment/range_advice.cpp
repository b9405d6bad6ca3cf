#include "environment/range_advice.h"

#include <ceres/jet.h>

#include <Eigen/LU>
#include <cmath>

#include "core/text.h"
#include "imaging/image_model.h"

namespace fathom {
namespace {

constexpr double kLargestShare = 0.05;  // of a parameter, that its sigma may be
constexpr double kVeilSigma = 0.005;    // or this: about one digital number of eight bits
// What nearest and farthest patches may err by together, however many there are: rounding, JPEG, blur.
constexpr double kCommonError = 0.001;
constexpr double kNearest_m = 0.3, kStep_m = 0.1, kFarther_m = 8;
constexpr double kWhite = 0.85, kBlack = 0.04;  // albedos of patches that would be added
constexpr const char* kColorNames[] = {"red", "green", "blue"};

/// Attenuation, veil and ambient light of one channel, and what is known of them.
struct ChannelKnowledge {
  using Jet = ceres::Jet<double, 3>;  // by the three

  double a, b, ambient;
  double nearest_m, farthest_m;
  Matrix3d covariance;

  /// That comes from a surface of this albedo.
  Jet light(double albedo, double z_m) const {
    const WaterColumn<Jet> water{Vector3<Jet>::Constant(Jet(a, 0)), Vector3<Jet>::Constant(Jet(b, 1))};
    const Vector3<Jet> scene = Vector3<Jet>::Constant(albedo * Jet(ambient, 2));
    return predictLight<Jet>(scene, Jet(z_m), Jet(z_m), water, {})[0];
  }
  /// Of a, from the change of contrast between the nearest and the farthest patches, if both err.
  double commonErrorA() const {
    const double middle_m = 0.5 * (nearest_m + farthest_m);
    const double contrast = light(kWhite, middle_m).a - light(kBlack, middle_m).a;
    return kCommonError / (contrast * (farthest_m - nearest_m));
  }
  double sigmaA() const { return std::hypot(std::sqrt(covariance(0, 0)), commonErrorA()); }
  double sigmaB() const { return std::sqrt(covariance(1, 1)); }
  bool suffices() const {
    return sigmaA() <= kLargestShare * a && sigmaB() <= std::max(kLargestShare * b, kVeilSigma);
  }
  /// With patches of this albedo, z and sigma added, as information so many times.
  ChannelKnowledge with(double z_m, double sigma, double count) const {
    Matrix3d information = covariance.inverse();
    for (const double albedo : {kWhite, kBlack}) {
      const Vector3d row = light(albedo, z_m).v;
      information += 0.5 * count / (sigma * sigma) * row * row.transpose();
    }
    return {a, b, ambient, std::min(nearest_m, z_m), std::max(farthest_m, z_m), information.inverse()};
  }
};

ChannelKnowledge channelOf(const WaterFit& fit, int channel) {
  const Eigen::Array3i rows{channel, 3 + channel, 6 + channel};
  const Vector9d p = waterParameters(fit.environment);
  return {p[rows[0]], p[rows[1]], p[rows[2]], fit.nearest_z_m, fit.farthest_z_m, fit.covariance(rows, rows)};
}

/// Information of the patches themselves, as a number of patches of the excess sigma, no more than one
/// image's.
double patchesOfAnImage(const WaterFit& fit) {
  return static_cast<double>(fit.patches) / static_cast<double>(std::max<std::size_t>(1, fit.images));
}

std::string wouldDo(const ChannelKnowledge& known, const WaterFit& fit, int channel) {
  const double sigma = std::max(fit.excess_sigma[channel], 1e-4), count = patchesOfAnImage(fit);
  std::string advice;
  for (double z = fit.farthest_z_m; z < fit.farthest_z_m + kFarther_m; z += kStep_m)
    if (known.with(z, sigma, count).suffices()) {
      advice = print("one from %.1f m", z);
      break;
    }
  for (double z = fit.nearest_z_m; z > kNearest_m; z -= kStep_m)
    if (known.with(z, sigma, count).suffices()) {
      advice += print("%sone from %.1f m", advice.empty() ? "" : " or ", z);
      break;
    }
  return advice.empty() ? "images both nearer and farther would be needed" : advice + " would do";
}

}  // namespace

std::vector<std::string> rangeWarnings(const std::vector<Patch>& patches, const WaterFit& fit) {
  std::vector<std::string> warnings;
  if (patches.empty()) return warnings;
  for (int c = 0; c < 3; ++c) {
    const ChannelKnowledge known = channelOf(fit, c);
    if (known.suffices()) continue;
    const double correlation = known.covariance(0, 1) / (known.sigmaA() * known.sigmaB());
    warnings.push_back(
        print("%s: images from %.2f to %.2f m do not tell attenuation from veil (a %.3f ± %.3f "
              "/m, b %.3f ± %.3f, correlation %.3f); ",
              kColorNames[c], fit.nearest_z_m, fit.farthest_z_m, known.a, known.sigmaA(), known.b,
              known.sigmaB(), correlation) +
        wouldDo(known, fit, c));
  }
  return warnings;
}

}  // namespace fathom
