#include "support/faulty_streams.h"

#include <algorithm>
#include <cmath>

#include "simulation/navigation_simulator.h"
#include "support/motions.h"

namespace fathom::test {
namespace {

Pose mounting(Random& random, double yaw_deg, double tilt_deg) {
  const auto angle = [&](double most_deg) { return radians(random.uniform(-most_deg, most_deg)); };
  return {rotationFromYawPitchRoll(angle(yaw_deg), angle(tilt_deg), angle(tilt_deg)),
          Vector3d(random.uniform(-0.4, 0.4), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3))};
}

Trajectory randomMotion(std::uint64_t seed, double duration_s) {
  Random random = Random::stream(seed, 2);
  struct Sine {
    double amplitude, rate, phase;
    double operator()(double t) const { return amplitude * std::sin(rate * t + phase); }
  };
  const auto sine = [&](double low, double high) {
    return Sine{random.uniform(low, high), random.uniform(0.15, 0.6), random.uniform(0, 6)};
  };
  const double size = random.uniform(0.5, 2);
  const std::array<Sine, 3> way{sine(size, 2 * size), sine(size / 2, size), sine(0.3, 0.9)};
  const std::array<Sine, 3> turn{sine(0.3, 1), sine(0.05, 0.15), sine(0.05, 0.15)};
  const double depth_m = random.uniform(3, 60), yaw = random.uniform(-3, 3),
               turning = random.uniform(-0.1, 0.1);
  std::vector<double> times_s;
  std::vector<Pose> poses;
  for (double t = 0; t <= duration_s + 0.05; t += 0.1) {
    times_s.push_back(t);
    poses.push_back({rotationFromYawPitchRoll(yaw + turning * t + turn[0](t), turn[1](t), turn[2](t)),
                     Vector3d(way[0](t), way[1](t), way[2](t) - depth_m)});
  }
  return {times_s, poses};
}

const Matrix3d kFrd = Vector3d(1, -1, -1).asDiagonal(), kHalfTurn = Vector3d(-1, -1, 1).asDiagonal();

Matrix3d nedFromEnu() {
  Matrix3d m;
  m << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  return m;
}

/// What of an INS's entries each fault makes; by hand, not by the program's own corrections.
void spoil(const std::string& name, const Vehicle& vehicle, InsSample& s) {
  const auto force = [&](const Matrix3d& m) { s.specific_force_ins = Vector3d(m * *s.specific_force_ins); };
  const auto rate = [&](const Matrix3d& m) {
    s.angular_velocity_ins = Vector3d(m * *s.angular_velocity_ins);
  };
  const auto attitude = [&](auto&& f) {
    if (s.R_odom_ins) s.R_odom_ins = Matrix3d(f(*s.R_odom_ins));
  };
  const Matrix3d I = Matrix3d::Identity();
  if (name == "accelerometer-in-g") force(I / 9.80665);
  if (name == "accelerometer-in-milli-g") force(I / 9.80665e-3);
  if (name == "accelerometer-without-gravity") {
    const Matrix3d R = s.R_odom_ins ? *s.R_odom_ins : Matrix3d(s.T_robot_ins.rotation);
    *s.specific_force_ins -= R.transpose() * Vector3d(0, 0, vehicle.gravity_m_s2);
  }
  if (name == "gyro-in-degrees") rate(I * 57.29578);
  if (name == "gyro-axes sign") rate(-I);
  if (name == "gyro-axes zyx") rate(I.rowwise().reverse());
  if (name == "accelerometer-axes frd") force(kFrd);
  if (name == "accelerometer-axes half-turn") force(kHalfTurn);
  if (name == "gyro-axes half-turn, and the accelerometer's") force(kHalfTurn), rate(kHalfTurn);
  if (name == "attitude-inverse") attitude([](const Matrix3d& R) { return R.transpose(); });
  if (name == "attitude-ned") attitude([](const Matrix3d& R) -> Matrix3d { return nedFromEnu() * R; });
  if (name == "attitude-ned-frd")
    attitude([](const Matrix3d& R) -> Matrix3d { return nedFromEnu() * R * kFrd; });
  if (name == "attitude-w-first")
    attitude([](const Matrix3d& R) {
      const Eigen::Quaterniond q(R);
      return Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
    });
  if (name == "ins-axes") {
    force(kFrd), rate(kFrd);
    attitude([](const Matrix3d& R) { return R * kFrd; });
  }
}

void spoil(const std::string& name, const Vehicle&, DvlSample& s) {
  if (!s.velocity_dvl) return;
  Vector3d& v = *s.velocity_dvl;
  if (name == "dvl-in-millimetres") v *= 1000;
  if (name == "dvl-in-centimetres") v *= 100;
  if (name == "dvl-in-knots") v /= 0.514444;
  if (name == "dvl-in-feet") v /= 0.3048;
  if (name == "dvl-turned") v = Eigen::AngleAxisd(0.7, Vector3d::UnitZ()) * v;
  if (name == "dvl-axes") v = kFrd * v;
  if (name == "dvl-axes up") v.z() = -v.z();
}

void spoil(const std::string& name, const Vehicle& vehicle, DepthSample& s) {
  const double air = vehicle.depth->atmospheric_pressure_pa;
  if (name == "pressure-falls") s.pressure_pa = 2 * air + 8e5 - s.pressure_pa;
  if (name == "pressure-in-kilopascal") s.pressure_pa /= 1000;
  if (name == "pressure-in-millibar") s.pressure_pa /= 100;
  if (name == "pressure-in-bar") s.pressure_pa /= 1e5;
  if (name == "pressure-is-depth")
    s.pressure_pa = (s.pressure_pa - air) / (vehicle.depth->water_density_kg_m3 * vehicle.gravity_m_s2);
}

/// What a sensor goes on reading when its driver hands out the last value.
void freeze(const std::string& name, const Reading& last, Reading& now) {
  if (auto* ins = std::get_if<InsSample>(&now)) {
    const auto& old = std::get<InsSample>(last);
    if (name == "gyro-frozen") ins->angular_velocity_ins = old.angular_velocity_ins;
    if (name == "accelerometer-frozen") ins->specific_force_ins = old.specific_force_ins;
    if (name == "attitude-frozen") ins->R_odom_ins = old.R_odom_ins;
  }
  if (name == "velocity-frozen")
    std::get<DvlSample>(now).velocity_dvl = std::get<DvlSample>(last).velocity_dvl;
  if (name == "pressure-frozen")
    std::get<DepthSample>(now).pressure_pa = std::get<DepthSample>(last).pressure_pa;
}

}  // namespace

bool StreamFault::isNamedBy(const Finding& finding) const {
  const std::string kind = name.substr(0, name.find(' '));
  return finding.name == kind || finding.what.find("--correct " + kind) != std::string::npos;
}

std::vector<StreamFault> streamFaults(const Vehicle& vehicle) {
  std::vector<StreamFault> faults{{"", ""}};
  for (const char* name : {"accelerometer-in-g", "accelerometer-in-milli-g", "accelerometer-without-gravity",
                           "gyro-in-degrees", "gyro-axes sign", "gyro-axes zyx", "accelerometer-axes frd",
                           "accelerometer-axes half-turn", "ins-axes", "gyro-frozen", "accelerometer-frozen",
                           "stamps-missing:INS", "stamps-equal:INS", "stamps-step-back:INS",
                           "stamps-of-arrival:INS", "stamps-of-arrival:INS twenty at once", "clock-rate:INS"})
    faults.push_back({name, labels::kIns});
  if (vehicle.ins->attitude_sigma)
    for (const char* name : {"gyro-axes half-turn, and the accelerometer's", "attitude-frozen",
                             "attitude-inverse", "attitude-ned", "attitude-ned-frd", "attitude-w-first"})
      faults.push_back({name, labels::kIns});
  for (const char* name :
       {"dvl-in-millimetres", "dvl-in-centimetres", "dvl-in-knots", "dvl-in-feet", "dvl-turned", "dvl-axes",
        "dvl-axes up", "velocity-repeated", "velocity-frozen", "clock-rate:DVL", "clock-offset:DVL"})
    faults.push_back({name, labels::kDvl});
  for (const char* name : {"pressure-in-kilopascal", "pressure-in-millibar", "pressure-in-bar",
                           "pressure-is-depth", "pressure-falls", "pressure-frozen"})
    faults.push_back({name, labels::kDepth});
  return faults;
}

Vehicle randomVehicle(std::uint64_t seed) {
  Random random = Random::stream(seed, 1);
  const auto within = [&](double low, double high) {
    return std::exp(random.uniform(std::log(low), std::log(high)));
  };
  Vehicle vehicle;
  InsSheet& ins = vehicle.ins.emplace();
  ins.rate_hz = random.uniform() < 0.5 ? 100 : 50;
  ins.gyro_sigma_rad_s = within(2e-4, 5e-3);
  ins.accelerometer_sigma_m_s2 = within(3e-3, 5e-2);
  ins.gyro_bias_sigma_rad_s = within(1e-5, 1e-3);
  ins.accelerometer_bias_sigma_m_s2 = within(1e-3, 3e-2);
  if (random.uniform() < 0.7) ins.attitude_sigma = radians(within(0.05, 1));
  ins.T_robot_ins = mounting(random, 180, 8);
  DvlSheet& dvl = vehicle.dvl.emplace();
  dvl.rate_hz = random.uniform() < 0.5 ? 5 : 8;
  dvl.velocity_sigma_xy_m_s = within(2e-3, 2e-2);
  dvl.velocity_sigma_z_m_s = within(1e-3, 1e-2);
  dvl.T_robot_dvl = mounting(random, 180, 4);
  DepthSheet& depth = vehicle.depth.emplace();
  depth.rate_hz = random.uniform() < 0.5 ? 5 : 10;
  depth.pressure_sigma_pa = within(20, 300);
  depth.T_robot_depth = mounting(random, 0, 0);
  return vehicle;
}

std::vector<Sample> randomDive(const Vehicle& vehicle, std::uint64_t seed) {
  constexpr double kDuration_s = 120;
  SimulationOptions options;
  options.vehicle = vehicle;
  options.seed = seed;
  options.duration_s = kDuration_s;
  options.sea_floor_z_m = -70;
  options.beam_max_range_m = 100;
  std::vector<Sample> samples;
  const Trajectory trajectory = randomMotion(seed, kDuration_s + 1);
  simulateNavigation(options, trajectory, [&](const Sample& s) {
    if (s.label != labels::kTruth) samples.push_back(s);
  });
  return samples;
}

void addFault(const StreamFault& fault, const Vehicle& vehicle, std::uint64_t seed,
              std::vector<Sample>& samples) {
  Random random = Random::stream(seed, 3);
  const Time start = samples.front().time;
  const double ppm = random.uniform(1000, 6000) * (random.uniform() < 0.5 ? -1 : 1);
  const bool arrival = fault.name.starts_with("stamps-of-arrival");
  Time before{}, before_that{};
  std::optional<Vector3d> kept;
  std::optional<Reading> frozen;
  std::size_t n = 0;
  double burst_s = 0;
  for (Sample& sample : samples) {
    if (sample.label != fault.label) continue;
    std::visit(
        [&]<class Entry>(Entry& entry) {
          if constexpr (requires { spoil(fault.name, vehicle, entry); }) spoil(fault.name, vehicle, entry);
        },
        sample.reading);
    const Time stamp = sample.time;
    const double t_s = secondsBetween(start, stamp);
    if (fault.name.starts_with("stamps-missing") && random.uniform() < 0.1) sample.time = Time{};
    if (fault.name.starts_with("stamps-equal") && n % 5 == 1) sample.time = before;
    if (fault.name.starts_with("stamps-step-back") && n % 900 == 899) sample.time = after(before_that, -0.5);
    if (fault.name.starts_with("clock-rate")) sample.time = after(start, t_s * (1 + 1e-6 * ppm));
    // In bundles, all when the last has come: of four, a millisecond or so apart, or of twenty.
    const std::size_t bundle = fault.name.ends_with("at once") ? 20 : 4;
    if (arrival)
      burst_s = n % bundle == 0 ? t_s + (static_cast<double>(bundle) - 0.8) / vehicle.ins->rate_hz
                                : burst_s + (bundle == 4 ? 1 : 1e-3) * random.uniform(0.0005, 0.0015);
    if (arrival) sample.time = after(start, burst_s);
    if (fault.name == "clock-offset:DVL")
      sample.time = after(start, t_s + (ppm > 0 ? 1 : -1) * (0.4 + 3e-4 * std::abs(ppm)));
    if (fault.name.ends_with("-frozen") && t_s > 70) {
      if (!frozen) frozen = sample.reading;
      freeze(fault.name, *frozen, sample.reading);
    }
    if (fault.name == "velocity-repeated") {
      auto& velocity = std::get<DvlSample>(sample.reading).velocity_dvl;
      if (kept && n % 20 > 4) velocity = kept;
      kept = velocity;
    }
    before_that = std::exchange(before, stamp);
    ++n;
  }
  if (!fault.name.starts_with("stamps-step-back"))
    std::stable_sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
      return a.time != Time{} && b.time != Time{} && a.time < b.time;
    });
}

}  // namespace fathom::test
