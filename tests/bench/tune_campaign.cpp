// `fathom tune` on simulated dives whose noise is 0.3 to 3 times what the vehicle file says: how near it
// comes, and how often its 95 % intervals hold the truth.
#include <CLI/CLI.hpp>
#include <iostream>
#include <map>

#include "core/progress.h"
#include "core/text.h"
#include "report/table.h"
#include "simulation/read_trajectory.h"
#include "support/drawn_dives.h"
#include "support/shipped.h"
#include "tuning/tune.h"

namespace fathom {
namespace {

constexpr double kInsRate_hz = 50.0;

Vehicle filedVehicle() {
  Vehicle vehicle = readVehicle(test::kRov);
  vehicle.camera.reset();
  vehicle.ins->rate_hz = kInsRate_hz;
  vehicle.ins->attitude_sigma = radians(0.5);
  return vehicle;
}

/// As `fathom tune` begins, with all that this vehicle has.
LocalizationOptions filedOptions() {
  LocalizationOptions options = readLocalizationOptions(test::kConfig / "improved.yaml");
  options.fuse = {kChannel<Gyro>, kChannel<Accelerometer>, kChannel<Attitude>,
                  kChannel<Dvl>,  kChannel<DvlBeams>,      kChannel<Depth>};
  options.smooth = false;
  return options;
}

/// What a dive is made with.
struct Truth {
  Vehicle vehicle = filedVehicle();
  /// From one reading to the next rate and acceleration change about as much as their sensors' noise. Of a
  /// robot that is driven far harder nothing tells the noise, of one far more gently nothing the drive.
  DrivingNoise drive{Vector3d::Constant(2.5e-5), Vector3d::Constant(1e-2)};
  std::map<std::string, double> values;  ///< by the tuned parameter's name, in its unit
};

Truth drawTruth(std::uint64_t seed, bool is_drive_known) {
  Random random = Random::stream(seed, 79);
  const auto factor = [&random] { return std::exp(random.uniform(std::log(0.3), std::log(3.0))); };
  Truth truth;
  const auto spoil = [&](Channel channel, auto&... sigmas) {
    const double times = factor();
    ((sigmas = sigmas * times), ...);
    truth.values["sigma of " + nameOf(channel)] = times;
  };
  InsSheet& ins = *truth.vehicle.ins;
  DvlSheet& dvl = *truth.vehicle.dvl;
  spoil(kChannel<Gyro>, ins.gyro_sigma_rad_s);
  spoil(kChannel<Accelerometer>, ins.accelerometer_sigma_m_s2);
  AttitudeSigma& attitude = *ins.attitude_sigma;
  spoil(kChannel<Attitude>, attitude.roll_rad, attitude.pitch_rad, attitude.heading_rad);
  spoil(kChannel<Dvl>, dvl.velocity_sigma_xy_m_s, dvl.velocity_sigma_z_m_s);
  spoil(kChannel<DvlBeams>, dvl.range_sigma_m);
  spoil(kChannel<Depth>, truth.vehicle.depth->pressure_sigma_pa);
  truth.values["gyro bias"] = degrees(ins.gyro_bias_sigma_rad_s *= factor());
  truth.values["accelerometer bias"] = ins.accelerometer_bias_sigma_m_s2 *= factor();
  truth.values["biases' time constant"] = ins.bias_time_constant_s;
  truth.drive.angular_velocity *= std::pow(factor(), 2);
  truth.drive.acceleration *= std::pow(factor(), 2);
  if (is_drive_known)
    for (const Regime regime : kEveryRegime) {
      const std::string in_regime(nameOf(regime));
      truth.values["angular acceleration, " + in_regime] = std::sqrt(truth.drive.angular_velocity.x());
      truth.values["jerk, " + in_regime] = std::sqrt(truth.drive.acceleration.x());
    }
  return truth;
}

/// Of a dive along a trajectory, or, without one, drawn from the filter's model.
TunedRecording dive(const Truth& truth, const Trajectory* trajectory, double duration_s, std::uint64_t seed) {
  SimulationOptions options;
  options.vehicle = truth.vehicle;
  options.seed = seed;
  TunedRecording recording;
  recording.setup.vehicle = filedVehicle();
  if (trajectory != nullptr) {
    options.duration_s = std::min(duration_s, trajectory->end_s() - trajectory->start_s());
    simulateNavigation(options, *trajectory, [&](const Sample& sample) {
      if (sample.label != labels::kTruth) recording.samples.push_back(sample);
    });
  } else {
    options.sea_floor_z_m = -45.0;
    constexpr double kInterval_s = 1.0 / kInsRate_hz;
    recording.samples =
        test::readingsOf(test::drawnMotion(truth.drive, kInterval_s, duration_s, seed), kInterval_s, options);
  }
  recording.setup.time_zero = recording.samples.front().time;
  return recording;
}

/// Of one parameter, over the dives.
struct Tally {
  std::vector<double> errors;  ///< |found / true - 1|
  int within = 0, covered = 0, not_constant = 0;
  int told = 0, told_within = 0, told_covered = 0;  ///< of those that the tuner vouches for

  void add(const TunedParameter& found, double truth) {
    constexpr double kAsked = 0.1;
    const double error = std::abs(found.after / truth - 1.0);
    const bool is_within = error <= kAsked, is_covered = found.low <= truth && truth <= found.high;
    errors.push_back(error);
    within += is_within;
    covered += is_covered;
    not_constant += !found.is_constant;
    if (!found.is_constant || !found.is_told || found.high > (1.0 + kAsked) * found.after) return;
    ++told;
    told_within += is_within;
    told_covered += is_covered;
  }

  double quantile(double share) const {
    std::vector<double> sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5)];
  }
};

std::string of(int part, int whole) { return print("%d of %d", part, whole); }

Table tableOf(const std::map<std::string, Tally>& tallies) {
  Table table{.header = {"parameter", "median", "90th", "within 10 %", "covered", "not constant",
                         "told to 10 %", "of these within", "covered"},
              .rows = {}};
  for (const auto& [name, t] : tallies) {
    const int dives = static_cast<int>(t.errors.size());
    table.rows.push_back({name, print("%.1f %%", 100 * t.quantile(0.5)),
                          print("%.1f %%", 100 * t.quantile(0.9)), of(t.within, dives), of(t.covered, dives),
                          of(t.not_constant, dives), of(t.told, dives), of(t.told_within, t.told),
                          of(t.told_covered, t.told)});
  }
  return table;
}

constexpr const char* kLegend =
    "covered: by the 95 % interval. not constant: the tuner says that noise or drive change, so that it does "
    "not "
    "vouch for\nthe value. told to 10 %: it vouches for it, and its interval is no wider. Biases and their "
    "time "
    "constant are to be judged\nby the coverage only: three axes over a dive of one or two time constants "
    "are a "
    "handful of independent values.\n";

struct Campaign {
  int dives = 20;
  std::uint64_t first_seed = 1;
  double duration_s = 150.0;
  bool shows_each = false;
};

void run(const Campaign& campaign, const Trajectory* trajectory) {
  std::map<std::string, Tally> tallies;
  Progress progress("dives");
  for (int k = 0; k < campaign.dives; ++k) {
    const std::uint64_t seed = campaign.first_seed + static_cast<std::uint64_t>(k);
    const Truth truth = drawTruth(seed, trajectory == nullptr);
    const TunedRecording recording = dive(truth, trajectory, campaign.duration_s, seed);
    const Tuning tuning = tune({recording}, filedOptions(), {},
                               [&](double fraction) { progress.update((k + fraction) / campaign.dives); });
    if (campaign.shows_each) std::cout << "seed " << seed << ": " << tuning.runs << " runs\n";
    for (const TunedParameter& found : tuning.parameters) {
      const auto known = truth.values.find(found.name);
      if (known != truth.values.end()) tallies[found.name].add(found, known->second);
      if (campaign.shows_each)
        std::cout << print("  %-38s %-24s true %-9.4g found %-9.4g %9.4g to %9.4g %s\n", found.name.c_str(),
                           found.unit.c_str(), known == truth.values.end() ? NAN : known->second, found.after,
                           found.low, found.high,
                           !found.is_told      ? "hardly told"
                           : found.is_constant ? ""
                                               : "not constant")
                  << std::flush;
    }
  }
  std::cout << formatTable(tableOf(tallies)) << "\n";
}

int run(int argc, char** argv) {
  CLI::App app("fathom tune on simulated dives with noise of 0.3 to 3 times the vehicle file's");
  Campaign campaign;
  std::string motion = "both";
  std::filesystem::path file = test::kConfig / "dive_trajectory.yaml";
  app.add_option("--dives", campaign.dives, "How many of each motion")->capture_default_str();
  app.add_option("--first-seed", campaign.first_seed, "Of the first one")->capture_default_str();
  app.add_option("--duration", campaign.duration_s, "Of a dive, s; at most as long as the trajectory")
      ->capture_default_str();
  app.add_option("--motion", motion, "Drawn from the filter's model, or the trajectory's, or both")
      ->check(CLI::IsMember({"drawn", "trajectory", "both"}))
      ->capture_default_str();
  app.add_option("--trajectory", file, "Where the second table's dives go")->capture_default_str();
  app.add_flag("--each", campaign.shows_each, "Also print what is found in each dive");
  CLI11_PARSE(app, argc, argv);
  if (motion != "trajectory") {
    std::cout << "motion drawn from the filter's model\n";
    run(campaign, nullptr);
  }
  if (motion != "drawn") {
    std::cout << "motion of " << file.filename().string() << "\n";
    const Trajectory trajectory = readTrajectory(file);
    run(campaign, &trajectory);
  }
  std::cout << kLegend;
  return 0;
}

}  // namespace
}  // namespace fathom

int main(int argc, char** argv) { return fathom::run(argc, argv); }
