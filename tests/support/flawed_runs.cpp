#include "support/flawed_runs.h"

#include <array>
#include <cmath>

namespace fathom::test {

PanelMap folded(PanelMap panel, double angle_rad) {
  const Pose fold{expSO3<double>(Vector3d(0, angle_rad, 0)), Vector3d::Zero()};
  for (Marker& marker : panel.markers)
    if (marker.T_panel_marker.position.x() > 0) marker.T_panel_marker = fold * marker.T_panel_marker;
  return panel;
}

PanelMap slipped(PanelMap panel, double along_m) {
  for (Marker& marker : panel.markers)
    if (marker.T_panel_marker.position.x() > 0) marker.T_panel_marker.position.y() += along_m;
  return panel;
}

void makeDvlQuadratic(std::vector<Sample>& samples, double k_s_m) {
  for (Sample& sample : samples)
    if (auto* dvl = std::get_if<DvlSample>(&sample.reading); dvl != nullptr && dvl->velocity_dvl)
      *dvl->velocity_dvl *= 1.0 + k_s_m * dvl->velocity_dvl->norm();
}

void makeGyroSensitive(std::vector<Sample>& samples, const Matrix3d& G) {
  for (Sample& sample : samples)
    if (auto* ins = std::get_if<InsSample>(&sample.reading);
        ins != nullptr && ins->angular_velocity_ins && ins->specific_force_ins)
      *ins->angular_velocity_ins += G * *ins->specific_force_ins;
}

DiagnosisRun outsideCatalogue(const BatchRun& nominal, std::size_t number, std::uint64_t seed) {
  DiagnosisRun run{"", nominal, {}, {}, 0, nullptr};
  Random random = Random::stream(seed, 4000 + number);
  run.run.seed = random.bits();
  const std::size_t size = number / 4 % 3;
  const auto named = [&](const char* what, double amount, const char* unit) {
    run.name = std::string(what) + " " + std::to_string(amount).substr(0, 7) + " " + unit;
  };
  if (number % 4 == 0) {
    const double angle_deg = std::array{0.02, 0.05, 0.2}[size];
    named("camera mount shakes", angle_deg, "deg");
    run.run.camera_shake_rad = radians(angle_deg);
  } else if (number % 4 == 1) {
    const double along_m = std::array{0.002, 0.005, 0.02}[size];
    named("panel's halves slipped", along_m, "m");
    run.run.true_panel = slipped(nominal.panel, along_m);
  } else if (number % 4 == 2) {
    const double k_s_m = std::array{0.1, 0.2, 0.4}[size];
    named("DVL quadratic", k_s_m, "s/m");
    run.change = [k_s_m](const BatchRun&, std::vector<Sample>& samples) { makeDvlQuadratic(samples, k_s_m); };
  } else {
    const double amount = std::array{1e-4, 3e-4, 1e-3}[size];
    named("gyro sensitive to acceleration", amount, "rad/s per m/s2");
    Matrix3d G;
    for (double& g : G.reshaped()) g = amount * random.normal();
    run.change = [G](const BatchRun&, std::vector<Sample>& samples) { makeGyroSensitive(samples, G); };
  }
  return run;
}

namespace {

void blotch(std::vector<ImagePatch>& patches, const Vector2d& centre_px, double darkest) {
  constexpr double kWidth_px = 60;
  for (ImagePatch& patch : patches)
    patch.radiance *=
        1 - darkest * std::exp(-(patch.pixel - centre_px).squaredNorm() / (2 * kWidth_px * kWidth_px));
}

void bendResponse(std::vector<ImagePatch>& patches, double exponent_error) {
  for (ImagePatch& patch : patches) {
    patch.radiance[0] = std::pow(patch.radiance[0], 1 + exponent_error);
    patch.radiance[2] = std::pow(patch.radiance[2], 1 - exponent_error);
  }
}

void addBubbles(std::vector<ImagePatch>& patches, double share, Random& random) {
  constexpr double kBright = 0.02;
  for (ImagePatch& patch : patches)
    if (patch.image % 2 == 0 && random.uniform() < share)
      patch.radiance += Vector3d::Constant(kBright * random.uniform());
}

}  // namespace

DiagnosisRun outsideLight(const BatchRun& nominal, std::size_t number, std::uint64_t seed) {
  DiagnosisRun run{"", nominal, {}, {}, 0, nullptr};
  Random random = Random::stream(seed, 5000 + number);
  run.run.seed = random.bits();
  const std::size_t size = number / 4 % 3;
  const auto named = [&](const char* what, double amount) {
    run.name = std::string(what) + " " + std::to_string(amount).substr(0, 5);
  };
  if (number % 4 == 0) {
    const double darkest = std::array{0.02, 0.05, 0.2}[size];
    const Vector2d centre_px(random.uniform(200, 440), random.uniform(150, 330));
    named("dark blotch on the port", darkest);
    run.change_light = [=](std::vector<ImagePatch>& patches) { blotch(patches, centre_px, darkest); };
  } else if (number % 4 == 1) {
    const double exponent_error = std::array{0.01, 0.03, 0.1}[size];
    named("response by colour", exponent_error);
    run.change_light = [=](std::vector<ImagePatch>& patches) { bendResponse(patches, exponent_error); };
  } else if (number % 4 == 2) {
    const double share = std::array{0.05, 0.1, 0.3}[size];
    const std::uint64_t stream = random.bits();
    named("bubbles before patches", share);
    run.change_light = [=](std::vector<ImagePatch>& patches) {
      Random places(stream);
      addBubbles(patches, share, places);
    };
  } else {
    const double blur_px2 = std::array{0.25, 0.5, 1.0}[size];
    named("a curved field of focus, px^2", blur_px2);
    run.change_edges = [=](std::vector<MarkerBlur>& blurs) {
      for (MarkerBlur& blur : blurs)
        blur.variance_px2 +=
            8 * blur.camera.idealAt(blur.pixel).squaredNorm() * Vector3d(blur_px2, 0, blur_px2);
    };
  }
  return run;
}

namespace {

/// As `keep` finds it in the first sample that has it, in all.
template <class Reading, class Keep>
void makeConstant(std::vector<Sample>& samples, const Keep& keep) {
  const Reading* first = nullptr;
  for (Sample& sample : samples)
    if (auto* reading = std::get_if<Reading>(&sample.reading)) {
      if (first == nullptr) first = reading;
      keep(*reading, *first);
    }
}

}  // namespace

std::vector<DiagnosisRun> wrongInputs(const BatchRun& nominal) {
  using Samples = std::vector<Sample>;
  std::vector<DiagnosisRun> runs;
  const auto add = [&](const char* name, const BatchRun& run,
                       std::function<void(const BatchRun&, Samples&)> change = {}) {
    runs.push_back({name, run, std::move(change), {}, 0, nullptr});
  };
  const double duration_s = nominal.duration_s;

  BatchRun still(duration_s, pathOf(duration_s, [](double) { return richPose(0); }));
  still.seed = nominal.seed;
  add("no motion", still);
  add("two samples", nominal, [](const BatchRun&, Samples& samples) { samples.resize(2); });

  add("constant DVL", nominal, [](const BatchRun&, Samples& samples) {
    makeConstant<DvlSample>(samples, [](DvlSample& all, const DvlSample& first) { all = first; });
  });
  add("constant gyro", nominal, [](const BatchRun&, Samples& samples) {
    makeConstant<InsSample>(samples, [](InsSample& all, const InsSample& first) {
      all.angular_velocity_ins = first.angular_velocity_ins;
    });
  });
  add("constant pressure", nominal, [](const BatchRun&, Samples& samples) {
    makeConstant<DepthSample>(samples, [](DepthSample& all, const DepthSample& first) { all = first; });
  });

  add("DVL of another dive", nominal, [](const BatchRun& run, Samples& samples) {
    BatchRun other(run.duration_s, pathOf(run.duration_s, [](double t) { return richPose(t + 137.0); }));
    const Samples others = other.samples();
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (std::holds_alternative<DvlSample>(samples[i].reading)) samples[i].reading = others[i].reading;
  });
  BatchRun other_map = nominal;
  other_map.true_panel = nominal.panel;
  for (Marker& marker : other_map.panel.markers) marker.id = (marker.id + 5) % 12;
  add("map of another panel", other_map);
  return runs;
}

}  // namespace fathom::test
