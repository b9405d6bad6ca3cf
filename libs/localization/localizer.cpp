#include "localization/localizer.h"

#include <deque>
#include <limits>

#include "core/stable_sort.h"
#include "localization/alignment.h"
#include "localization/fuser.h"
#include "localization/future_stamps.h"
#include "localization/input_watch.h"
#include "localization/lost_monitor.h"
#include "localization/smoother.h"

namespace fathom {
namespace {

bool isFusible(const Sample& sample, LandmarkOptions::Form form) {
  if (std::holds_alternative<PoseSample>(sample.reading) && baseOf(sample.label) == labels::kMarkers)
    return form == LandmarkOptions::Form::mean;
  if (std::holds_alternative<PanelSample>(sample.reading)) return form == LandmarkOptions::Form::joint;
  return isOfInstrument(sample);
}

bool isLandmark(const Sample& sample) {
  return std::holds_alternative<PanelSample>(sample.reading) || baseOf(sample.label) == labels::kMarkers;
}

/// With the options' biases in the place of the vehicle file's.
LocalizationSetup withBiases(LocalizationSetup setup) {
  if (auto& ins = setup.vehicle.ins; ins && setup.options.biases) {
    ins->gyro_bias_sigma_rad_s = setup.options.biases->gyro_sigma_rad_s;
    ins->accelerometer_bias_sigma_m_s2 = setup.options.biases->accelerometer_sigma_m_s2;
    ins->bias_time_constant_s = setup.options.biases->time_constant_s;
  }
  return setup;
}

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
      : setup_(withBiases(std::move(setup))),
        sink_(std::move(sink)),
        fuser_(setup_),
        lost_(setup_.options.lost),
        watch_(setup_.options, reporter()),
        future_([this](const Sample& sample, double stamp_s) { take(sample, stamp_s); }, reporter()) {
    for (const Regime regime : kEveryRegime) noise_[static_cast<std::size_t>(regime)] = noiseIn(regime);
    before_->after.landmarks = fuser_.startLandmarks();
    before_->after.noise.biases = {noise_[0].gyro_bias_sigma_rad_s.x(),
                                   noise_[0].accelerometer_bias_sigma_m_s2.x()};
    for (const PanelPrior& panel : setup_.panels)
      summary_.panels.push_back({panel.name, PanelResult::State::unseen, {panel.T_odom_panel}, {}});
  }

  void add(const Sample& sample) override {
    if (!isFusible(sample, setup_.options.landmarks.form)) return;
    ++summary_.samples;
    future_.add(sample, secondsBetween(setup_.time_zero, sample.time));
  }

  LocalizationSummary finish() override {
    future_.finish();
    if (!summary_.started && !waiting_.empty()) start();
    if (!summary_.started) {
      summary_.failure = "no entry of a navigation sensor";
      return summary_;
    }
    finalizeBefore(std::numeric_limits<double>::infinity());
    summary_.panels = panelResults();
    const AdaptedDrive drive = before_->after.noise.drive();
    summary_.turning_times = std::sqrt(drive.turning_times);
    summary_.pushing_times = std::sqrt(drive.pushing_times);
    if (setup_.options.smooth) smooth();
    for (const Channel channel : kEveryChannel) {
      ChannelSummary& s = channels_[indexOf(channel)];
      const std::size_t count = s.fused + s.gated;
      if (count == 0) continue;
      s.nis_mean /= static_cast<double>(count);
      std::tie(s.nis_band95_low, s.nis_band95_high) = meanChiSquareBand(s.degrees_of_freedom, count);
      s.sigma_times = std::sqrt(before_->after.noise.varianceTimes(channel));
      summary_.channels[channel] = s;
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
    FusionLog log;
  };

  /// When a reading was valid: its stamp, but for a calibrated latency.
  double validity_s(const Sample& sample) const {
    const double stamp_s = secondsBetween(setup_.time_zero, sample.time);
    if (setup_.calibration.on.none()) return stamp_s;
    const EffectParameters<double> effects = setup_.calibration.of(Instance::of(sample.label));
    if (isLandmark(sample)) return stamp_s + validityOffset<Camera>(effects, stamp_s);
    double valid_s = stamp_s;
    withInstrument(sample, [&]<class Instrument>(const auto&, const Instance&) {
      valid_s += validityOffset<typename Instrument::Instrument>(effects, stamp_s);
    });
    return valid_s;
  }

  ProcessNoise noiseIn(Regime regime) const {
    ProcessNoise noise = setup_.options.noise;
    if (const auto driven = setup_.options.driven.find(regime); driven != setup_.options.driven.end()) {
      noise.angular_velocity = driven->second.angular_velocity;
      noise.acceleration = driven->second.acceleration;
    }
    if (const auto& ins = setup_.vehicle.ins) {
      noise.gyro_bias_sigma_rad_s.setConstant(ins->gyro_bias_sigma_rad_s);
      noise.accelerometer_bias_sigma_m_s2.setConstant(ins->accelerometer_bias_sigma_m_s2);
      noise.bias_time_constant_s = ins->bias_time_constant_s;
    }
    return noise;
  }

  ProcessNoise noiseAt(const NavigationState<double>& x, const AdaptedDrive& drive) const {
    return drive.appliedTo(noise_[static_cast<std::size_t>(setup_.options.regimes.of(x.motion))]);
  }
  ProcessNoise noiseAt(const GatedFilter<N>& state) const {
    return noiseAt(state.filter.x, state.noise.drive());
  }

  InputWatch::Report reporter() {
    return [this](double t, const char* kind, std::string text) { report(t, kind, std::move(text)); };
  }

  /// In order of arrival, of a stamp that may be believed.
  void take(const Sample& sample, double stamp_s) {
    if (!watch_.accept(sample, stamp_s)) return;
    if (summary_.started) return insert(validity_s(sample), sample);
    waiting_.push_back(sample);
    if (tellsPosition(sample)) ++waiting_fixes_;
    if (isAligned(secondsBetween(waiting_.front().time, sample.time))) start();
  }

  bool isAligned(double waited_s) const {
    if (waited_s < setup_.options.alignment_s) return false;
    constexpr int kEnough = 3;  // of which two agree where one is false
    const bool expected = waiting_fixes_ > 0 || std::any_of(setup_.panels.begin(), setup_.panels.end(),
                                                            [](const PanelPrior& p) { return p.isKnown(); });
    const bool comes_a_fix = !setup_.start && expected && waiting_fixes_ < kEnough;
    return !comes_a_fix || waited_s >= setup_.options.first_fix_s;
  }

  /// How it stands and moves at first is told by the first seconds, however long it waits for a fix.
  std::vector<Sample> firstSeconds() const {
    std::vector<Sample> first;
    std::copy_if(waiting_.begin(), waiting_.end(), std::back_inserter(first), [this](const Sample& sample) {
      return secondsBetween(waiting_.front().time, sample.time) <= setup_.options.alignment_s;
    });
    return first;
  }

  void start() {
    const InitialState initial = alignInitially(setup_, firstSeconds());
    summary_.started = true;
    summary_.failure.clear();
    summary_.start_source = initial.source;
    summary_.start_t_s = initial.t_s;
    before_->after.filter.x = initial.state;
    before_->after.filter.P = initial.sigma.template head<N>().cwiseAbs2().asDiagonal();
    before_->after.frame = OdomFrame(initial.defined);
    before_->t_s = initial.t_s;
    startWhereFixesAgree();
    report(initial.t_s, "start", summary_.start_source);
    lost_.start(initial.t_s);
    next_output_s_ = initial.t_s;
    for (const Sample& sample : std::exchange(waiting_, {})) {
      const double t_s = validity_s(sample);
      insert(t_s, sample);
    }
  }

  /// Where the fixes among the waiting samples put the start, most of them, by the dead reckoning between.
  void startWhereFixesAgree() {
    GatedFilter<N>& start = before_->after;
    if (!start.frame.defined().any()) return;
    const std::vector<ReckonedFix> fixes = reckonedFixes();
    const auto agreed = consensus(start.frame, fixes);
    if (!agreed) return;
    start.filter.moveFrame(agreed->move);
    start.frame.meet({}, *agreed->by);
    if (agreed->by->tells.heading)
      LandmarkFuser<N>::startByFix(start.landmarks, agreed->isInDoubt() && fuser_.uses(agreed->by->channel));
    summary_.start_source += print("; moved to where %s is seen: %zu of %zu fixes agree",
                                   agreed->by->by.c_str(), agreed->agreeing, agreed->of);
  }

  std::vector<ReckonedFix> reckonedFixes() {
    Entry now = *before_;
    std::vector<const Sample*> by_time;
    for (const Sample& sample : waiting_) by_time.push_back(&sample);
    stableSort(by_time, [this](const Sample* a, const Sample* b) { return validity_s(*a) < validity_s(*b); });
    std::vector<ReckonedFix> fixes;
    for (const Sample* sample : by_time) {
      const double t_s = validity_s(*sample);
      if (t_s > now.t_s) now.after.filter.predict(t_s - now.t_s, noiseAt(now.after));
      now.t_s = std::max(now.t_s, t_s);
      const std::vector<ReckonedFix> seen = fuser_.fixes(now.after, *sample, t_s);
      fixes.insert(fixes.end(), seen.begin(), seen.end());
      if (seen.empty()) fuser_.fuse(now.after, *sample, t_s, now.log);
    }
    return fixes;
  }

  void insert(double t_s, const Sample& sample) {
    if (t_s < before_->t_s) {
      report(t_s, "too-late",
             sample.label + print(" is %.3f s older than the history reaches; left out", before_->t_s - t_s));
      return;
    }
    // Few are late, and those a little.
    const auto later = std::find_if(entries_.rbegin(), entries_.rend(), [t_s](const auto& entry) {
                         return entry->t_s <= t_s;
                       }).base();
    if (later != entries_.end()) ++summary_.late_fused;
    auto position = entries_.insert(later, unusedEntry());
    (*position)->t_s = t_s;
    (*position)->sample = sample;
    for (; position != entries_.end(); ++position)
      process(position == entries_.begin() ? *before_ : **std::prev(position), **position);
    finalizeBefore(entries_.back()->t_s - setup_.options.history_s);
  }

  /// Entries are used again and again: they are large.
  std::unique_ptr<Entry> unusedEntry() {
    if (unused_.empty()) return std::make_unique<Entry>();
    auto entry = std::move(unused_.back());
    unused_.pop_back();
    return entry;
  }

  void process(const Entry& last, Entry& entry) {
    entry.after = last.after;
    if (entry.t_s > last.t_s) entry.after.filter.predict(entry.t_s - last.t_s, noiseAt(last.after));
    entry.log.clear();
    fuser_.fuse(entry.after, entry.sample, entry.t_s, entry.log);
  }

  /// Nothing older can change any more: hand it out. The last entry before the horizon stays the base for
  /// later ones.
  void finalizeBefore(double horizon_s) {
    while (!entries_.empty() && entries_.front()->t_s < horizon_s) {
      unused_.push_back(std::exchange(before_, std::move(entries_.front())));
      entries_.pop_front();
      account(*before_);
      landmark_seen_ = landmark_seen_ || isLandmark(before_->sample);
      const bool last_at_this_time = entries_.empty() || entries_.front()->t_s > before_->t_s;
      if (last_at_this_time) output(*before_);
    }
  }

  void output(const Entry& entry) {
    summary_.end_t_s = entry.t_s;
    judge(entry);
    if constexpr (N == kFullSize) noteBiases(entry);
    if (setup_.options.smooth) {
      smoother_.record(entry.t_s, entry.after.filter, std::exchange(anew_, {}));
      drives_.push_back(entry.after.noise.drive());
    }
    // A landmark moves the estimate at once: between grid points that would not show.
    if (!std::exchange(landmark_seen_, false) && entry.t_s < next_output_s_ - 1e-6) return;
    sink_.estimate(makeEstimate(entry.t_s, entry.after.filter.x, entry.after.filter.P, entry.after.frame));
    outputs_.push_back(entry.t_s);
    // The grid is kept, however unevenly readings come.
    const double period = 1.0 / setup_.options.output_rate_hz;
    if (entry.t_s >= next_output_s_ - 1e-6)
      next_output_s_ += period * (1.0 + std::floor((entry.t_s - next_output_s_) / period + 1e-6));
    if (!setup_.options.smooth) outputs_.clear();
  }

  Estimate makeEstimate(double t_s, const NavigationState<double>& x,
                        const typename ErrorStateFilter<N>::Matrix& P, const OdomFrame& frame) const {
    return {after(setup_.time_zero, t_s),
            t_s,
            x,
            P.template topLeftCorner<6, 6>(),
            P.diagonal().template segment<3>(kVelocity).cwiseMax(0.0).cwiseSqrt(),
            summary_.lost_since_s.has_value(),
            frame.defined()};
  }

  void smooth() {
    smoother_.smooth([this](std::size_t k, const auto& x) { return noiseAt(x, drives_[k]); }, [](double) {});
    std::size_t k = 0;
    for (const double t_s : outputs_) {
      while (smoother_.time(k) < t_s) ++k;
      sink_.smoothed(makeEstimate(t_s, smoother_.state(k), smoother_.covariance(k), before_->after.frame));
    }
  }

  void account(const Entry& entry) {
    for (const FrameMove& move : entry.log.frame_moves) smoother_.moveFrame(move);
    for (const Innovation& innovation : entry.log.innovations) account(innovation);
    for (const Event& event : entry.log.events) report(event.t_s, event.kind, event.text);
    for (const auto& [panel, move] : entry.log.moves) summary_.panels[panel].moves.push_back(move);
    anew_.insert(anew_.end(), entry.log.anew.begin(), entry.log.anew.end());
    if (entry.log.corrected) lost_.corrected(entry.t_s);
  }

  void account(const Innovation& innovation) {
    ChannelSummary& s = channels_[indexOf(innovation.channel)];
    s.degrees_of_freedom = innovation.degrees_of_freedom;
    s.nis_mean += innovation.nis;
    ++(innovation.fused ? s.fused : s.gated);
    sink_.innovation(innovation);
    lost_.reading(innovation.t_s, innovation.channel, innovation.fused, innovation.contradicts);
    if (innovation.rejected_in_a_row == kRejectionsBelieved &&
        (innovation.channel != kChannel<Landmark> || setup_.options.gate.kind == Gate::Kind::fixed))
      report(innovation.t_s, "rejected",
             nameOf(innovation.channel) + " rejected " + std::to_string(kRejectionsBelieved) +
                 " times in a row: filter and sensor contradict each other; believed again");
  }

  /// Whether the estimate can be relied on; says so where that changes.
  void judge(const Entry& entry) {
    const auto sigma = [&](int first) {
      return std::sqrt(entry.after.filter.P.diagonal().template segment<3>(first).sum());
    };
    const auto reason = lost_.judge(entry.t_s, sigma(kPosition), sigma(kOrientation),
                                    entry.after.frame.isTurned(), entry.after.landmarks->monitor.isInDoubt());
    if (reason && !summary_.lost_since_s) {
      report(entry.t_s, "lost", *reason);
      summary_.lost_since_s = entry.t_s;
      summary_.lost_reason = *reason;
    } else if (!reason && summary_.lost_since_s) {
      report(entry.t_s, "found", print("after %.1f s", entry.t_s - *summary_.lost_since_s));
      summary_.lost_since_s.reset();
      summary_.lost_reason.clear();
    }
  }

  /// A bias far beyond the vehicle file's sigma is a fault of the file or of the instrument; told once.
  void noteBiases(const Entry& entry) {
    const auto& x = entry.after.filter.x;
    noteBias(entry, kGyroBias, x.gyro_bias_rad_s, noise_[0].gyro_bias_sigma_rad_s,
             {"gyro", degrees(1.0), "deg/s"});
    noteBias(entry, kAccelerometerBias, x.accelerometer_bias_m_s2, noise_[0].accelerometer_bias_sigma_m_s2,
             {"accelerometer", 1.0, "m/s2"});
  }

  struct BiasText {
    const char* instrument;
    double scale;
    const char* unit;
  };
  void noteBias(const Entry& entry, int block, const Vector3d& bias, const Vector3d& sheet_sigma,
                const BiasText& text) {
    bool& told = bias_told_[block == kGyroBias ? 0 : 1];
    if (told) return;
    const Vector3d sigma =
        entry.after.filter.P.diagonal().template segment<3>(block).cwiseMax(0.0).cwiseSqrt();
    // As many of the file's sigmas as no bias has, and surely so.
    constexpr double kFar = 6.0, kSurely = 6.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double size = std::abs(bias[axis]);
      if (size <= kFar * sheet_sigma[axis] + kSurely * sigma[axis]) continue;
      told = true;
      return report(
          entry.t_s, "bias",
          print("the %s's bias about its %c axis is %.4g +- %.2g %s, %.0f times the vehicle file's sigma",
                text.instrument, "xyz"[axis], bias[axis] * text.scale, sigma[axis] * text.scale, text.unit,
                size / sheet_sigma[axis]));
    }
  }

  std::vector<PanelResult> panelResults() const {
    std::vector<PanelResult> results = summary_.panels;
    for (std::size_t i = 0; i < results.size(); ++i) {
      const int attached = before_->after.landmarks->attached[i];
      results[i].state = attached == LandmarkMemory::kExact    ? PanelResult::State::known
                         : attached == LandmarkMemory::kUnseen ? PanelResult::State::unseen
                                                               : PanelResult::State::estimated;
      if (attached >= 0) results[i].T_odom_panel = before_->after.filter.attachedPose(attached);
    }
    return results;
  }

  void report(double t_s, const std::string& kind, std::string text) {
    ++summary_.event_counts[kind];
    sink_.event({t_s, kind, std::move(text)});
  }

  const LocalizationSetup setup_;
  const LocalizationSink sink_;
  std::array<ProcessNoise, kEveryRegime.size()> noise_;  ///< of each regime
  Fuser<N> fuser_;
  LostMonitor lost_;
  InputWatch watch_;
  FutureStamps future_;
  LocalizationSummary summary_;
  std::array<ChannelSummary, kChannelCount> channels_{};
  std::vector<Sample> waiting_;  ///< until alignment
  int waiting_fixes_ = 0;
  std::unique_ptr<Entry> before_ = std::make_unique<Entry>();  ///< what the first of the entries starts from
  std::deque<std::unique_ptr<Entry>> entries_;
  std::vector<std::unique_ptr<Entry>> unused_;
  double next_output_s_ = 0.0;
  std::array<bool, 2> bias_told_{};  ///< gyro, accelerometer
  bool landmark_seen_ = false;       ///< since the latest output
  std::vector<double> outputs_;
  std::vector<int> anew_;  ///< since the smoother's last record
  Smoother<N> smoother_;
  std::vector<AdaptedDrive> drives_;  ///< at each step of the smoother
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

}  // namespace fathom
