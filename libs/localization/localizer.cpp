#include "localization/localizer.h"

#include <cstdio>
#include <deque>
#include <limits>
#include <set>

#include "core/text.h"
#include "core/uncertain_pose.h"
#include "localization/alignment.h"
#include "localization/chi_square.h"
#include "localization/measurements.h"
#include "localization/smoother.h"
#include "sensors/models.h"

namespace fathom {
namespace {

bool isFinite(const Sample& sample) {
  struct Visitor {
    bool operator()(const InsSample& s) const {
      return (!s.angular_velocity_ins || s.angular_velocity_ins->allFinite()) &&
             (!s.specific_force_ins || s.specific_force_ins->allFinite()) &&
             (!s.R_odom_ins || s.R_odom_ins->allFinite());
    }
    bool operator()(const DvlSample& s) const { return !s.velocity_dvl || s.velocity_dvl->allFinite(); }
    bool operator()(const DvlBeamsSample& s) const {
      return std::all_of(s.beams.begin(), s.beams.end(),
                         [](const DvlBeam& beam) { return !beam.range_m || std::isfinite(*beam.range_m); });
    }
    bool operator()(const DepthSample& s) const { return std::isfinite(s.pressure_pa); }
    bool operator()(const PoseSample& s) const {
      return Pose::fromMrpt(s.T_odom_robot.mean).position.allFinite() &&
             s.T_odom_robot.cov.asEigen().allFinite();
    }
    bool operator()(const ImageSample&) const { return true; }
    bool operator()(const StereoSample&) const { return true; }
    bool operator()(const PanelSample& s) const {
      return std::all_of(s.panels.begin(), s.panels.end(), [](const SeenPanel& seen) {
        const auto& [pose, covariance] = seen.T_camera_panel;
        return pose.position.allFinite() && pose.rotation.allFinite() && covariance.allFinite();
      });
    }
    bool operator()(const MarkersSample&) const { return true; }
    bool operator()(const RecordingHeader&) const { return true; }
    bool operator()(const UnknownSample&) const { return true; }
  };
  return std::visit(Visitor{}, sample.reading);
}

bool isFusible(const Sample& sample) {
  if (std::holds_alternative<PoseSample>(sample.reading))
    return sample.label == labels::kUsbl || sample.label == labels::kMarkers;
  return std::holds_alternative<InsSample>(sample.reading) ||
         std::holds_alternative<DvlSample>(sample.reading) ||
         std::holds_alternative<DvlBeamsSample>(sample.reading) ||
         std::holds_alternative<DepthSample>(sample.reading);
}

/// The filter with what it remembers of its gates: a late reading rewinds both.
template <int N>
struct GatedFilter {
  ErrorStateFilter<N> filter;
  std::array<int, kAllChannels.size()> rejected_in_a_row{};
};

/// One rejected reading is an outlier. This many in a row are a filter that has gone astray: the channel is
/// believed again until a reading passes the gate, so that a gate cannot lock the filter out for good.
constexpr int kRejectionsBelieved = 5;

/// Turns one sample into updates of a filter.
template <int N>
class Fuser {
 public:
  Fuser(const LocalizationSetup& setup) : setup_(setup) {
    context_.gravity_odom = setup.vehicle.gravityOdom();
    context_.calibration = setup.calibration;
    for (int dof = 1; dof <= 6; ++dof)
      gates_[static_cast<std::size_t>(dof)] = setup.options.gate.kind == Gate::Kind::chi_square
                                                  ? chiSquareQuantile(dof, setup.options.gate.probability)
                                                  : std::numeric_limits<double>::infinity();
    for (const Channel channel : setup.options.fuse) fused_.insert(channel);
  }

  void fuse(GatedFilter<N>& state, const Sample& sample, double t_s, std::vector<Innovation>& log) const {
    ErrorStateFilter<N>& filter = state.filter;
    const auto update = [&](Channel channel, const auto& m) {
      constexpr int M = std::remove_cvref_t<decltype(m.residual)>::RowsAtCompileTime;
      int& streak = state.rejected_in_a_row[static_cast<std::size_t>(channel)];
      const double gate = passes(m) ? gates_[M] : kNever;
      const bool believed = streak >= kRejectionsBelieved;
      const double nis = filter.update(m, believed ? kAlways : gate);
      streak = nis <= gate ? 0 : streak + 1;
      log.push_back({t_s, channel, M, nis, believed || nis <= gate, streak});
    };
    if (const auto* ins = std::get_if<InsSample>(&sample.reading)) fuseIns(filter, *ins, update);
    if (const auto* dvl = std::get_if<DvlSample>(&sample.reading)) fuseDvl(filter, *dvl, update);
    if (const auto* beams = std::get_if<DvlBeamsSample>(&sample.reading)) fuseBeams(filter, *beams, update);
    if (const auto* depth = std::get_if<DepthSample>(&sample.reading)) fuseDepth(filter, *depth, update);
    if (const auto* pose = std::get_if<PoseSample>(&sample.reading)) {
      if (sample.label == labels::kUsbl) fuseUsbl(filter, *pose, update);
      if (sample.label == labels::kMarkers) fuseLandmark(filter, *pose, update);
    }
  }

 private:
  bool uses(Channel channel) const { return fused_.contains(channel); }

  template <class Update>
  void fuseIns(ErrorStateFilter<N>& f, const InsSample& s, const Update& update) const {
    if (!setup_.vehicle.ins) return;
    const InsSheet& sheet = *setup_.vehicle.ins;
    if (s.angular_velocity_ins && uses(Channel::gyro))
      update(Channel::gyro, SensorMeasurements<N>::gyro(f.x, *s.angular_velocity_ins, s.T_robot_ins,
                                                        sheet.gyro_sigma_rad_s, context_));
    if (s.specific_force_ins && uses(Channel::accelerometer))
      update(Channel::accelerometer,
             SensorMeasurements<N>::accelerometer(f.x, *s.specific_force_ins, s.T_robot_ins,
                                                  sheet.accelerometer_sigma_m_s2, context_));
    if (s.R_odom_ins && sheet.attitude_sigma_rad && uses(Channel::attitude)) {
      const double variance = *sheet.attitude_sigma_rad * *sheet.attitude_sigma_rad;
      update(Channel::attitude, SensorMeasurements<N>::attitude(f.x, *s.R_odom_ins, s.T_robot_ins,
                                                                Matrix3d::Identity() * variance, context_));
    }
  }

  template <class Update>
  void fuseDvl(ErrorStateFilter<N>& f, const DvlSample& s, const Update& update) const {
    if (!setup_.vehicle.dvl || !s.velocity_dvl || !uses(Channel::dvl)) return;
    const DvlSheet& sheet = *setup_.vehicle.dvl;
    const Vector3d sigma(sheet.velocity_sigma_xy_m_s, sheet.velocity_sigma_xy_m_s,
                         sheet.velocity_sigma_z_m_s);
    update(Channel::dvl, SensorMeasurements<N>::dvl(f.x, *s.velocity_dvl, s.T_robot_dvl, sigma, context_));
  }

  template <class Update>
  void fuseBeams(ErrorStateFilter<N>& f, const DvlBeamsSample& s, const Update& update) const {
    // Without a state for the sea floor a range says nothing of the vehicle's height.
    if (N != kFullSize || !setup_.vehicle.dvl || !uses(Channel::altitude)) return;
    const DvlSheet& sheet = *setup_.vehicle.dvl;
    for (const DvlBeam& beam : s.beams)
      if (beam.range_m)
        update(Channel::altitude,
               SensorMeasurements<N>::beam(f.x, *beam.range_m, sheet.T_robot_dvl, beam.T_robot_beam,
                                           sheet.range_sigma_m, context_));
  }

  template <class Update>
  void fuseDepth(ErrorStateFilter<N>& f, const DepthSample& s, const Update& update) const {
    if (!setup_.vehicle.depth || !uses(Channel::depth)) return;
    update(Channel::depth, SensorMeasurements<N>::depth(f.x, s.pressure_pa, *setup_.vehicle.depth,
                                                        s.T_robot_depth, context_));
  }

  template <class Update>
  void fuseUsbl(ErrorStateFilter<N>& f, const PoseSample& s, const Update& update) const {
    if (!uses(Channel::usbl)) return;
    const Pose T_robot_usbl = setup_.vehicle.usbl ? setup_.vehicle.usbl->T_robot_usbl : Pose{};
    update(Channel::usbl,
           SensorMeasurements<N>::usbl(f.x, Pose::fromMrpt(s.T_odom_robot.mean).position, T_robot_usbl,
                                       Matrix3d(s.T_odom_robot.cov.asEigen().topLeftCorner<3, 3>())));
  }

  template <class Update>
  void fuseLandmark(ErrorStateFilter<N>& f, const PoseSample& s, const Update& update) const {
    if (uses(Channel::landmark)) update(Channel::landmark, poseMeasurement<N>(f.x, s.T_odom_robot));
  }

  /// The paper's fixed gate, which looks at poses only.
  template <class AnyMeasurement>
  bool passes(const AnyMeasurement& m) const {
    const Gate& rule = setup_.options.gate;
    if constexpr (AnyMeasurement::Columns::size == 6 && decltype(m.residual)::RowsAtCompileTime == 6)
      return rule.kind != Gate::Kind::fixed || (m.residual.template head<3>().norm() <= rule.max_position_m &&
                                                m.residual.template tail<3>().norm() <= rule.max_angle_rad);
    return true;
  }

  static constexpr double kAlways = std::numeric_limits<double>::infinity();
  static constexpr double kNever = -1.0;  ///< below every NIS
  const LocalizationSetup& setup_;
  MeasurementContext context_;
  std::array<double, 7> gates_{};
  std::set<Channel> fused_;
};

/// Names what is wrong with the stream of samples.
class InputWatch {
 public:
  InputWatch(const LocalizationSetup& setup, std::function<void(double, const char*, std::string)> report)
      : options_(setup.options), report_(std::move(report)) {}

  /// True where the sample may be used. `t_s` is its stamp.
  bool accept(const Sample& sample, double t_s) {
    if (!isFinite(sample)) {
      report_(t_s, "not-a-number", sample.label + " has a value that is not finite; the entry is left out");
      return false;
    }
    auto [it, first] = last_.try_emplace(sample.label, t_s);
    if (!first && t_s == it->second) {
      report_(t_s, "duplicate", sample.label + " repeats its time stamp; the second entry is left out");
      return false;
    }
    if (!first && t_s - it->second > options_.gap_s && isLongFor(sample.label, t_s - it->second))
      report_(t_s, "silent", sample.label + print(" was silent for %.3f s", t_s - it->second));
    if (!first && t_s > it->second) noteInterval(sample.label, t_s - it->second);
    it->second = std::max(it->second, t_s);
    if (any_ && t_s - newest_ > options_.gap_s)
      report_(t_s, "gap", print("no sensor for %.3f s; bridged by the motion model", t_s - newest_));
    if (any_ && newest_ - t_s > options_.history_s)
      report_(t_s, "time-jump", print("time jumps back by %.3f s", newest_ - t_s));
    newest_ = any_ ? std::max(newest_, t_s) : t_s;
    any_ = true;
    return true;
  }

 private:
  /// A sensor that is slow anyway is not silent: judged against its own mean interval so far.
  bool isLongFor(const std::string& label, double interval) const {
    const auto it = intervals_.find(label);
    return it == intervals_.end() || interval > 5.0 * it->second.first / it->second.second;
  }
  void noteInterval(const std::string& label, double interval) {
    auto& [sum, count] = intervals_[label];
    sum += interval;
    count += 1.0;
  }

  const LocalizationOptions& options_;
  std::function<void(double, const char*, std::string)> report_;
  std::map<std::string, double> last_;
  std::map<std::string, std::pair<double, double>> intervals_;
  double newest_ = 0.0;
  bool any_ = false;
};

}  // namespace

/// A localizer whatever the size of its state.
class Localizer::Run {
 public:
  virtual ~Run() = default;
  virtual void add(const Sample& sample) = 0;
  virtual LocalizationSummary finish() = 0;
};

template <int N>
class Localizer::RunOf : public Run {
 public:
  RunOf(LocalizationSetup setup, LocalizationSink sink)
      : setup_(std::move(setup)),
        sink_(std::move(sink)),
        fuser_(setup_),
        watch_(setup_,
               [this](double t, const char* kind, std::string text) { report(t, kind, std::move(text)); }) {
    noise_ = setup_.options.noise;
    if (const auto& ins = setup_.vehicle.ins) {
      noise_.gyro_bias_sigma_rad_s.setConstant(ins->gyro_bias_sigma_rad_s);
      noise_.accelerometer_bias_sigma_m_s2.setConstant(ins->accelerometer_bias_sigma_m_s2);
      noise_.bias_time_constant_s = ins->bias_time_constant_s;
    }
    dvl_offset_s_ = dvlValidityOffset(setup_.calibration);
  }

  void add(const Sample& sample) override {
    if (!isFusible(sample)) return;
    ++summary_.samples;
    const double stamp_s = secondsBetween(setup_.time_zero, sample.time);
    if (!watch_.accept(sample, stamp_s)) return;
    if (summary_.started) {
      const double t_s = validity_s(sample);
      return insert(t_s, sample);
    }
    waiting_.push_back(sample);
    if (stamp_s - secondsBetween(setup_.time_zero, waiting_.front().time) >= setup_.options.alignment_s)
      start();
  }

  LocalizationSummary finish() override {
    if (!summary_.started && !waiting_.empty()) start();
    if (!summary_.started) {
      summary_.failure = "no entry of a navigation sensor";
      return summary_;
    }
    finalizeBefore(std::numeric_limits<double>::infinity());
    if (setup_.options.smooth) smooth();
    for (auto& [channel, s] : summary_.channels) {
      const std::size_t count = s.fused + s.gated;
      s.nis_mean /= static_cast<double>(count);
      std::tie(s.nis_band95_low, s.nis_band95_high) = meanChiSquareBand(s.degrees_of_freedom, count);
    }
    return summary_;
  }

 private:
  /// One reading with the filter as it was after it: late readings are inserted and what follows is done
  /// again.
  struct Entry {
    double t_s = 0.0;
    Sample sample;
    GatedFilter<N> after;
    std::vector<Innovation> innovations;
  };

  /// When a reading was valid: its stamp, but for a calibrated latency.
  double validity_s(const Sample& sample) const {
    const bool is_dvl = std::holds_alternative<DvlSample>(sample.reading) ||
                        std::holds_alternative<DvlBeamsSample>(sample.reading);  // one ping for both
    return secondsBetween(setup_.time_zero, sample.time) + (is_dvl ? dvl_offset_s_ : 0.0);
  }

  void start() {
    const InitialState initial = alignInitially(setup_, waiting_);
    summary_.started = true;
    summary_.failure.clear();
    summary_.start_source = initial.source;
    summary_.start_t_s = initial.t_s;
    report(initial.t_s, "start", initial.source);
    before_.filter.x = initial.state;
    before_.filter.P = initial.sigma.template head<N>().cwiseAbs2().asDiagonal();
    before_t_s_ = initial.t_s;
    next_output_s_ = initial.t_s;
    for (Sample& sample : std::exchange(waiting_, {})) {
      const double t_s = validity_s(sample);
      insert(t_s, std::move(sample));
    }
  }

  void insert(double t_s, Sample sample) {
    if (t_s < before_t_s_) {
      report(t_s, "too-late",
             sample.label + print(" is %.3f s older than the history reaches; left out", before_t_s_ - t_s));
      return;
    }
    const auto later = std::upper_bound(entries_.begin(), entries_.end(), t_s,
                                        [](double t, const Entry& entry) { return t < entry.t_s; });
    if (later != entries_.end()) ++summary_.late_fused;
    auto position = entries_.insert(later, Entry{t_s, std::move(sample), {}, {}});
    for (; position != entries_.end(); ++position) process(position);
    finalizeBefore(entries_.back().t_s - setup_.options.history_s);
  }

  void process(typename std::deque<Entry>::iterator entry) {
    const bool first = entry == entries_.begin();
    entry->after = first ? before_ : std::prev(entry)->after;
    const double dt = entry->t_s - (first ? before_t_s_ : std::prev(entry)->t_s);
    if (dt > 0.0) entry->after.filter.predict(dt, noise_);
    entry->innovations.clear();
    fuser_.fuse(entry->after, entry->sample, entry->t_s, entry->innovations);
  }

  /// Nothing older can change any more: hand it out. The last entry before the horizon stays the base for
  /// later ones.
  void finalizeBefore(double horizon_s) {
    while (!entries_.empty() && entries_.front().t_s < horizon_s) {
      Entry& entry = entries_.front();
      for (const Innovation& innovation : entry.innovations) account(innovation);
      const bool last_at_this_time = entries_.size() == 1 || entries_[1].t_s > entry.t_s;
      if (last_at_this_time) output(entry);
      before_ = entry.after;
      before_t_s_ = entry.t_s;
      entries_.pop_front();
    }
  }

  void output(const Entry& entry) {
    summary_.end_t_s = entry.t_s;
    if (setup_.options.smooth) smoother_.record(entry.t_s, entry.after.filter);
    if (entry.t_s < next_output_s_ - 1e-6) return;
    sink_.estimate(makeEstimate(entry.t_s, entry.after.filter.x, entry.after.filter.P));
    outputs_.push_back(entry.t_s);
    // The grid is kept, however unevenly readings come.
    const double period = 1.0 / setup_.options.output_rate_hz;
    next_output_s_ += period * (1.0 + std::floor((entry.t_s - next_output_s_) / period + 1e-6));
    if (!setup_.options.smooth) outputs_.clear();
  }

  Estimate makeEstimate(double t_s, const NavigationState<double>& x,
                        const typename ErrorStateFilter<N>::Matrix& P) const {
    return {after(setup_.time_zero, t_s), t_s, x, P.template topLeftCorner<6, 6>(),
            P.diagonal().template segment<3>(kVelocity).cwiseMax(0.0).cwiseSqrt(), false};
  }

  void smooth() {
    smoother_.smooth(noise_, [](double) {});
    std::size_t k = 0;
    for (const double t_s : outputs_) {
      while (smoother_.time(k) < t_s) ++k;
      sink_.smoothed(makeEstimate(t_s, smoother_.state(k), smoother_.covariance(k)));
    }
  }

  void account(const Innovation& innovation) {
    ChannelSummary& s = summary_.channels[innovation.channel];
    s.degrees_of_freedom = innovation.degrees_of_freedom;
    s.nis_mean += innovation.nis;
    ++(innovation.fused ? s.fused : s.gated);
    sink_.innovation(innovation);
    if (innovation.rejected_in_a_row == kRejectionsBelieved)
      report(innovation.t_s, "rejected",
             nameOf(innovation.channel) + " rejected " + std::to_string(kRejectionsBelieved) +
                 " times in a row: filter and sensor contradict each other; believed again");
  }

  void report(double t_s, const char* kind, std::string text) {
    ++summary_.event_counts[kind];
    sink_.event({t_s, kind, std::move(text)});
  }

  const LocalizationSetup setup_;
  const LocalizationSink sink_;
  ProcessNoise noise_;
  Fuser<N> fuser_;
  InputWatch watch_;
  double dvl_offset_s_ = 0.0;
  LocalizationSummary summary_;
  std::vector<Sample> waiting_;  ///< until alignment
  GatedFilter<N> before_;        ///< the state that the first entry starts from
  double before_t_s_ = 0.0;
  std::deque<Entry> entries_;
  double next_output_s_ = 0.0;
  std::vector<double> outputs_;
  Smoother<N> smoother_;
};

Localizer::Localizer(LocalizationSetup setup, LocalizationSink sink) {
  if (setup.options.bias_states)
    run_ = std::make_unique<RunOf<kFullSize>>(std::move(setup), std::move(sink));
  else
    run_ = std::make_unique<RunOf<kCoreSize>>(std::move(setup), std::move(sink));
}
Localizer::~Localizer() = default;
Localizer::Localizer(Localizer&&) noexcept = default;
Localizer& Localizer::operator=(Localizer&&) noexcept = default;

void Localizer::add(const Sample& sample) { run_->add(sample); }
LocalizationSummary Localizer::finish() { return run_->finish(); }

LocalizationSummary localize(const LocalizationSetup& setup,
                             const std::function<std::optional<Sample>()>& next,
                             const LocalizationSink& sink) {
  Localizer localizer(setup, sink);
  while (const auto sample = next()) localizer.add(*sample);
  return localizer.finish();
}

mrpt::poses::CPose3DPDFGaussian posePdf(const Estimate& estimate) {
  const auto& motion = estimate.state.motion;
  return UncertainPose{{motion.R_odom_robot, motion.position_odom}, estimate.pose_covariance}.toMrpt();
}

}  // namespace fathom
