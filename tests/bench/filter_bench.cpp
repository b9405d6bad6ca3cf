// Predict + update a second of ErrorStateFilter, and of the Localizer around it, beside the same filter
// written the textbook way, in one run, on the two shared inputs. CPU time, the best of rounds that take
// turns.
//     filter_bench [FOLDER with syn_inputs.csv and syn_inputs_split.csv]
// Whether the covariance lasts, 10^7 steps on ill-conditioned readings:
//     filter_bench --long [STEPS]
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "core/chi_square.h"
#include "localization/alignment.h"
#include "localization/covariance_arithmetic.h"
#include "localization/localizer.h"
#include "support/ekf_inputs.h"
#include "support/ill_conditioned.h"
#include "support/textbook_filter.h"

using namespace fathom;
using namespace fathom::test;

namespace {

constexpr double kAlways = std::numeric_limits<double>::infinity();
constexpr double kGateProbability = 0.9999;

/// The gate for so many degrees of freedom.
double gateOf(Eigen::Index dof) {
  static const std::vector<double> gates = [] {
    std::vector<double> quantiles{0.0};
    for (int k = 1; k <= 15; ++k) quantiles.push_back(chiSquareQuantile(k, kGateProbability));
    return quantiles;
  }();
  return gates.at(static_cast<std::size_t>(dof));
}

ProcessNoise tunedNoise() {
  ProcessNoise noise;
  noise.angular_velocity.setConstant(1e-3);
  noise.acceleration.setConstant(1e-2);
  return noise;
}

struct Start {
  double t_s = 0;
  NavigationState<double> x;
  Eigen::Matrix<double, 15, 15> P;
};

struct Run {
  double seconds = 1e9;  ///< the best so far
  NavigationState<double> x;
};

template <class Work>
void keepBest(Run& run, Work&& work) {
  const std::clock_t begin = std::clock();
  run.x = work();
  run.seconds = std::min(run.seconds, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
}

double update(ErrorStateFilter<15>& filter, const auto& m, const EkfLine&, double gate) {
  return filter.update(m, gate).nis;
}
double update(TextbookFilter<15>& filter, const auto& m, const EkfLine& line, double gate) {
  return filter.update(m, line.index, gate);
}

template <class Filter>
NavigationState<double> filtered(const std::vector<EkfLine>& lines, const Start& start, bool gated) {
  const ProcessNoise noise = tunedNoise();
  Filter filter;
  filter.x = start.x;
  filter.P = start.P;
  double last_t = start.t_s;
  for (const EkfLine& line : lines) {
    if (line.t > last_t) filter.predict(line.t - last_t, noise);
    last_t = line.t;
    withMeasurement<15>(filter.x, line, [&](const auto& m) {
      return update(filter, m, line, gated ? gateOf(m.residual.size()) : kAlways);
    });
  }
  return filter.x;
}

/// A recording as instruments and a detector of panels would make it, and the same readings in the order in
/// which a Localizer fuses them. There is no gravity: the file's accelerations are free of it.
struct Recording {
  LocalizationSetup setup;
  std::vector<Sample> samples;
  std::vector<EkfLine> lines;
  Start start;
};

constexpr double kAttitudeSigma_rad = 0.03;  // the larger one of the file's: an INS has one for all axes

LocalizationSetup setupFor() {
  LocalizationSetup setup;
  setup.vehicle.gravity_m_s2 = 0;
  auto& ins = setup.vehicle.ins.emplace();
  ins.gyro_sigma_rad_s = 0.005;
  ins.accelerometer_sigma_m_s2 = 0.05;
  ins.attitude_sigma = kAttitudeSigma_rad;
  auto& dvl = setup.vehicle.dvl.emplace();
  dvl.velocity_sigma_xy_m_s = dvl.velocity_sigma_z_m_s = 0.02;
  setup.options.fuse = {kChannel<Gyro>, kChannel<Accelerometer>, kChannel<Attitude>, kChannel<Dvl>,
                        kChannel<Landmark>};
  setup.options.bias_states = false;
  setup.options.noise = tunedNoise();
  setup.options.gate.probability = kGateProbability;
  setup.options.alignment_s = 0;
  setup.panels.push_back({"panel", Pose{}});
  setup.time_zero = fromUnixSeconds(1.7e9);
  return setup;
}

EkfLine part(const EkfLine& line, int first, const Matrix3d& R) {
  EkfLine part = line;
  part.index = {first, first + 1, first + 2};
  part.R = R;
  return part;
}

void addIns(Recording& recording, const EkfLine& line, Time time) {
  const auto& z = line.z.motion;
  recording.samples.push_back(
      {time, labels::kIns,
       InsSample{Pose{}, z.angular_velocity_robot, z.acceleration_robot, z.R_odom_robot}});
  recording.lines.push_back(part(line, kAngularVelocity, line.R.block<3, 3>(3, 3)));
  recording.lines.push_back(part(line, kAcceleration, line.R.block<3, 3>(6, 6)));
  recording.lines.push_back(
      part(line, kOrientation, kAttitudeSigma_rad * kAttitudeSigma_rad * Matrix3d::Identity()));
}

void addOther(Recording& recording, const EkfLine& line, Time time) {
  const auto& z = line.z.motion;
  if (line.sensor == "dvl") {
    recording.samples.push_back({time, labels::kDvl, DvlSample{Pose{}, z.velocity_robot}});
  } else {
    const UncertainPose T_odom_robot{{z.R_odom_robot, z.position_odom}, line.R};
    recording.samples.push_back({time, labels::kPanel, PanelSample{Pose{}, {{0, T_odom_robot.inverse()}}}});
  }
  recording.lines.push_back(line);
}

Recording recordingOf(const EkfInputs& inputs) {
  Recording recording{setupFor(), {}, {}, {}};
  const auto& first = inputs.lines.front();
  recording.setup.start = StartPose{{first.z.motion.R_odom_robot, first.z.motion.position_odom}};
  for (std::size_t i = 1; i < inputs.lines.size(); ++i) {
    const EkfLine& line = inputs.lines[i];
    const Time time = after(recording.setup.time_zero, line.t);
    line.sensor == "ins" ? addIns(recording, line, time) : addOther(recording, line, time);
  }
  const InitialState initial = alignInitially(recording.setup, {recording.samples.front()});
  recording.start = {initial.t_s, initial.state, initial.sigma.head<15>().cwiseAbs2().asDiagonal()};
  return recording;
}

NavigationState<double> localized(const Recording& recording) {
  NavigationState<double> last;
  LocalizationSink sink;
  sink.estimate = [&](const Estimate& estimate) { last = estimate.state; };
  Localizer localizer(recording.setup, sink);
  for (const Sample& sample : recording.samples) localizer.add(sample);
  localizer.finish();
  return last;
}

template <class Ours, class Textbook>
void print(const char* what, const char* unit, std::size_t count, Ours&& ours, Textbook&& textbook) {
  Run fast, plain;
  for (int round = 0; round < 5; ++round) {
    for (int k = 0; k < 3; ++k) keepBest(fast, ours);
    keepBest(plain, textbook);
  }
  const double number = static_cast<double>(count);
  std::printf("%-24s %9.0f %s a second, textbook %8.0f: %5.2f times as fast; states differ by %.1e\n", what,
              number / fast.seconds, unit, number / plain.seconds, plain.seconds / fast.seconds,
              difference<15>(fast.x, plain.x).cwiseAbs().maxCoeff());
}

void printCore(const char* name, const EkfInputs& inputs) {
  const auto& first = inputs.lines.front();
  const std::vector<EkfLine> lines(inputs.lines.begin() + 1, inputs.lines.end());
  const Start start{first.t, first.z, first.R};
  for (const bool gated : {false, true})
    print((std::string("core, ") + name + (gated ? ", gate" : "")).c_str(), "updates", lines.size(),
          [&] { return filtered<ErrorStateFilter<15>>(lines, start, gated); },
          [&] { return filtered<TextbookFilter<15>>(lines, start, gated); });
}

/// With its noise as stated, which is what the textbook's does, and following what innovations show.
void printLocalizer(const EkfInputs& inputs) {
  Recording recording = recordingOf(inputs);
  for (const bool adapts : {false, true}) {
    recording.setup.options.adapts_noise = adapts;
    print(
        adapts ? "Localizer, adaptive" : "Localizer", "samples", recording.samples.size(),
        [&] { return localized(recording); },
        [&] { return filtered<TextbookFilter<15>>(recording.lines, recording.start, true); });
  }
}

/// Four rows that count what they are multiplied by.
struct CountedFour {
  static inline int products = 0;
  std::array<double, 4> rows;

  friend CountedFour operator*(CountedFour a, double factor) {
    products += 4;
    for (double& row : a.rows) row *= factor;
    return a;
  }
  CountedFour& operator+=(const CountedFour& b) {
    for (std::size_t i = 0; i < 4; ++i) rows[i] += b.rows[i];
    return *this;
  }
  CountedFour& operator-=(const CountedFour& b) {
    for (std::size_t i = 0; i < 4; ++i) rows[i] -= b.rows[i];
    return *this;
  }
  friend CountedFour operator+(CountedFour a, const CountedFour& b) { return a += b; }
};

void transpose(CountedFour (&m)[4]) {
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) std::swap(m[i].rows[j], m[j].rows[i]);
}

/// Multiply-adds of a cycle of the core on covariances: prediction, and an update by so many numbers.
int multiplyAdds(int size) {
  PaddedMatrix<15> P = Eigen::Matrix<double, 15, 15>::Identity();
  const std::array<double, 15> q{};
  const Matrix3d turn = Matrix3d::Identity();
  Border<15> border;
  border.begin(size);
  for (int k = 0; k < size; ++k) {
    std::copy_n(P.padded() + 16 * k, 16, border.column(k));
    border.columnOfS(k)[k] = 2.0;
  }
  CountedFour::products = 0;
  kernels::propagate<CountedFour, 15>(P.padded(), {turn, turn, turn, turn, turn, turn, 0.01}, q.data(), 1.0);
  kernels::eliminate<CountedFour, 15>(border);
  kernels::subtract<CountedFour, 15>(P.padded(), border);
  kernels::turn<CountedFour, 15>(P.padded(), turn);
  return CountedFour::products;
}

/// So many steps on readings that are as hard on a covariance as they come.
int lastLong(long steps) {
  IllConditionedRun<15> run(processorHas(Instructions::wide) ? Instructions::wide : Instructions::base);
  double least = 1.0;
  for (long k = 0; k < steps; ++k) {
    run.step();
    if (k % 1000 != 0) continue;
    least = std::min(least, run.leastEigenvalue());
    if (run.isSymmetric() && least > 0.0) continue;
    std::printf("after %ld steps: not symmetric or not positive definite\n", k + 1);
    return 1;
  }
  std::printf("%ld steps: symmetric; least eigenvalue of the correlations %.1e\n", steps, least);
  return 0;
}

/// Where the generator leaves its files; empty where it cannot be run.
std::filesystem::path generated() {
  const auto folder = std::filesystem::temp_directory_path() / "fathom-bench";
  const auto script = std::filesystem::path(FATHOM_SOURCE_DIR) / "../shared/ekf_inputs/gen_syn.py";
  std::filesystem::create_directories(folder);
  const std::string command =
      "cd '" + folder.string() + "' && /usr/bin/python3 '" + script.string() + "' > /dev/null";
  return std::system(command.c_str()) == 0 ? folder : std::filesystem::path();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--long")
    return lastLong(argc > 2 ? std::atol(argv[2]) : 10'000'000);
  const std::filesystem::path folder = argc > 1 ? argv[1] : generated();
  const auto joint = folder / "syn_inputs.csv", split = folder / "syn_inputs_split.csv";
  if (!std::filesystem::exists(joint) || !std::filesystem::exists(split)) {
    std::fprintf(stderr, "no inputs; to make them takes ../shared/ekf_inputs and python3-numpy\n");
    return 2;
  }
  const EkfInputs inputs = readEkfInputs(joint);
  printCore("joint", inputs);
  printCore("split", readEkfInputs(split));
  printLocalizer(inputs);
  std::printf("multiply-adds of a cycle on covariances, whole fours: %d joint, %d split\n", multiplyAdds(9),
              multiplyAdds(3));
  return 0;
}
