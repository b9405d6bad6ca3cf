#include "estimation/readings.h"

#include <ceres/jet.h>

#include <algorithm>
#include <numeric>

#include "core/random.h"
#include "estimation/reading_inputs.h"
#include "imaging/camera_geometry.h"
#include "imaging/two_views.h"
#include "sensors/channel_model.h"

namespace fathom {
namespace {

/// Columns of three each, by their first.
std::vector<int> triples(std::initializer_list<int> firsts) {
  std::vector<int> columns;
  for (const int first : firsts)
    for (int i = 0; i < 3; ++i) columns.push_back(first + i);
  return columns;
}

// Of images: what a model depends on of the motion, and the call of it.

struct MarkerReader {
  static constexpr bool kMayBeLate = true;
  static std::vector<int> motion() { return triples({kPositionColumn, kOrientationColumn}); }
  BatchMarker seen;
  double t_s;
  bool isAboveWater() const { return seen.camera.above_water; }
  template <class T>
  Eigen::Matrix<T, 8, 1> predict(const ReadingInputs<T>& in) const {
    const auto corners =
        predictDetectedCorners(in.state, in.panel, seen.marker, seen.camera, seen.T_robot_camera, seen.light,
                               in.effects, t_s, seen.T_left_right);
    Eigen::Matrix<T, 8, 1> all;
    for (Eigen::Index k = 0; k < 4; ++k)
      all.template segment<2>(2 * k) = corners[static_cast<std::size_t>(k)];
    return all;
  }
};

struct TiePointReader {
  static constexpr bool kMayBeLate = false;
  using LeftAside = Shutter<double>;  ///< the cameras stand still against each other
  static std::vector<int> motion() { return {}; }
  SeenByBoth seen;
  Eigen::Vector4d sense;
  double t_s;
  template <class T>
  Eigen::Matrix<T, 1, 1> predict(const ReadingInputs<T>& in) const {
    return Eigen::Matrix<T, 1, 1>(
        contradiction(seen, in.R_left_right, in.right_in_left, in.effects, t_s, sense));
  }
};

struct PatchReader {
  static constexpr bool kMayBeLate = true;
  static std::vector<int> motion() { return {}; }
  ImagePatch seen;
  double t_s;
  std::vector<int> colours;
  std::vector<LampSheet> lamps;
  template <class T>
  Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1> predict(const ReadingInputs<T>& in) const {
    const Vector3<T> all = predictPatch(in.state, in.panel, seen, lamps, in.water, in.effects, t_s) +
                           in.flaws.template segment<3>(kFalseLight);
    return all(colours);
  }
};

struct BlurReader {
  static constexpr bool kMayBeLate = false;
  using LeftAside = Mounting<double, Camera>;  ///< a turn hardly changes how fast things move
  static std::vector<int> motion() { return {}; }
  MarkerBlur seen;
  double t_s;
  template <class T>
  Vector3<T> predict(const ReadingInputs<T>& in) const {
    return predictBlur(in.state, in.panel, seen, in.flaws[kLensBlur], in.effects, t_s);
  }
};

struct SpecksReader {
  static constexpr bool kMayBeLate = false;
  static std::vector<int> motion() { return {}; }
  ImageSpecks seen;
  double t_s;
  template <class T>
  Eigen::Matrix<T, kSpeckClasses, 1> predict(const ReadingInputs<T>& in) const {
    auto specks = predictSpecks(seen.volumes, in.effects, t_s);
    specks[0] += in.flaws[kFalseSpecks];
    return specks.matrix();
  }
};

struct TextureReader {
  static constexpr bool kMayBeLate = false;
  static std::vector<int> motion() { return {}; }
  ImageTexture seen;
  double t_s;
  template <class T>
  Eigen::Matrix<T, 2, 1> predict(const ReadingInputs<T>& in) const {
    return predictTexture(seen.noise, in.effects, t_s);
  }
};

struct AccelerationReader {
  static constexpr bool kMayBeLate = false;
  static std::vector<int> motion() {
    return triples({kOrientationColumn, kAccelerationColumn, kRateDerivativeColumn});
  }
  double t_s;
  template <class T>
  Eigen::Matrix<T, 6, 1> predict(const ReadingInputs<T>& in) const {
    Eigen::Matrix<T, 6, 1> both;
    both << in.state.acceleration_robot, in.state.angular_acceleration_robot;
    return both;
  }
};

struct PoseReader {
  static constexpr bool kMayBeLate = false;
  static std::vector<int> motion() { return triples({kPositionColumn, kOrientationColumn}); }
  Pose T_odom_about;
  double t_s;
  template <class T>
  Eigen::Matrix<T, 6, 1> predict(const ReadingInputs<T>& in) const {
    Eigen::Matrix<T, 6, 1> both;
    both << in.state.position_odom,
        logSO3<T>(in.state.R_odom_robot * T_odom_about.rotation.transpose().template cast<T>());
    return both;
  }
};

/// Columns at once, through a model that gives as many Jets as it has rows.
template <class Predict>
Eigen::VectorXd differentiated(const std::vector<int>& columns, Eigen::MatrixXd& derivative,
                               const Predict& predict) {
  Eigen::VectorXd prediction;
  std::size_t first = 0;
  do {  // once even by nothing: there is a prediction
    const auto jets = predict(first);
    if (first == 0) {
      prediction.resize(jets.size());
      derivative.resize(jets.size(), static_cast<Eigen::Index>(columns.size()));
      for (Eigen::Index i = 0; i < jets.size(); ++i) prediction[i] = jets[i].a;
    }
    const auto count =
        std::min<Eigen::Index>(kJetSize, std::ssize(columns) - static_cast<Eigen::Index>(first));
    for (Eigen::Index i = 0; i < jets.size(); ++i)
      derivative.row(i).segment(static_cast<Eigen::Index>(first), count) = jets[i].v.head(count).transpose();
    first += kJetSize;
  } while (first < columns.size());
  return prediction;
}

EffectParameters<double> effectsAt(const ForwardPoint& point) {
  EffectParameters<double> effects;
  effects.values = point.effects;
  effects.on = point.on;
  return effects;
}

/// Whether any of them is a latency.
bool anyLatency(const std::bitset<kEffectCount>& effects) {
  static const std::bitset<kEffectCount> latencies = [] {
    std::bitset<kEffectCount> all;
    forEachEffect([&]<class Effect>() {
      all[kEffectIndex<Effect>] = kIsValidityOffset<typename Effect::template Stage<double>>;
    });
    return all;
  }();
  return (effects & latencies).any();
}

/// All that effects may do to it at its own place in the image.
template <class Reader>
class ModelOf final : public ReadingModel {
 public:
  explicit ModelOf(Reader reader) : reader_(std::move(reader)) {}

  double validity_s(const ForwardPoint& point) const override {
    return kMayBeLate ? validityOffset<Camera>(effectsAt(point), reader_.t_s) : 0.0;
  }

  Eigen::VectorXd predict(const ForwardPoint& point) const override {
    return reader_.predict(inputs<double>(point, {}, 0));
  }

  Eigen::VectorXd differentiate(const ForwardPoint& point, const std::vector<int>& columns,
                                Eigen::MatrixXd& derivative) const override {
    return differentiated(columns, derivative, [&](std::size_t first) {
      return reader_.predict(inputs<SensorJet>(point, columns, first));
    });
  }

  const std::vector<int>& motionColumns() const override {
    static const std::vector<int> columns = Reader::motion();
    return columns;
  }

  /// Found once for all of a kind, which ask for the same but for cameras above water.
  bool dependsOn(std::size_t effect) const override {
    if constexpr (requires { reader_.isAboveWater(); })
      if (reader_.isAboveWater()) {
        static const std::bitset<kEffectCount> above_water = effectsAskedFor();
        return above_water[effect];
      }
    static const std::bitset<kEffectCount> mask = effectsAskedFor();
    return mask[effect];
  }

 private:
  /// Those that its equations ask for, and latencies where they look at the motion.
  std::bitset<kEffectCount> effectsAskedFor() const {
    ForwardPoint point;
    point.on.set();
    point.T_odom_panel.position = {0, 0, 1};
    auto in = inputsAt<double>(point, reader_.t_s, {}, 0);
    std::bitset<kEffectCount> effects;
    in.effects.asked = &effects;
    reader_.predict(in);
    if (kMayBeLate) effects |= fathom::effectsAt<double, ValidityOffset<double, Camera>>();
    if constexpr (requires { typename Reader::LeftAside; })
      effects &= ~fathom::effectsAt<double, typename Reader::LeftAside>();
    return effects;
  }

  /// Whether it looks at the motion at its own time.
  static constexpr bool kMayBeLate = Reader::kMayBeLate;

  template <class T>
  ReadingInputs<T> inputs(const ForwardPoint& point, const std::vector<int>& columns,
                          std::size_t first) const {
    ReadingInputs<T> in = inputsAt<T>(point, reader_.t_s, columns, first);
    if (kMayBeLate && (anyLatency(in.effects.on) || point.knot_latency_s))
      carryOn<T>(in, point, validityOffset<Camera>(in.effects, reader_.t_s));
    return in;
  }

  Reader reader_;
};

/// Where a motion's derivatives are not zero: those that a channel's equations depend on, latencies apart.
std::vector<int> tracedMotion(Channel channel) {
  const Inputs<double> example = exampleInputs();
  ForwardPoint point;
  Random random(3);
  point.motion = {{example.state.R_odom_robot, example.state.position_odom},
                  random.normal3(),
                  random.normal3(),
                  random.normal3(),
                  random.normal3(),
                  random.normal3(),
                  random.normal3()};
  point.effects = example.effects.values;
  point.on.set();
  const Vehicle vehicle;
  std::vector<int> all(kMotionSize), depends;
  std::iota(all.begin(), all.end(), 0);
  Eigen::MatrixXd derivative;
  differentiated(all, derivative, [&](std::size_t first) {
    auto in = inputsAt<SensorJet>(point, example.t_s, all, first);
    in.world = {vehicle.gravityOdom(), SensorJet(example.world.sea_floor_z_m)};
    return modelOf(channel).differentiate(in, vehicle, exampleObservation());
  });
  for (const int c : all)
    if (!derivative.col(c).isZero(0)) depends.push_back(c);
  return depends;
}

/// An instrument's.
class InstrumentReading final : public ReadingModel {
 public:
  InstrumentReading(const BatchReading& reading, const Vehicle& vehicle)
      : model_(modelOf(reading.channel)),
        channel_(reading.channel),
        seen_(reading.seen),
        t_s_(reading.t_s()),
        vehicle_(vehicle) {}

  double validity_s(const ForwardPoint& point) const override {
    return model_.validityOffset(effectsAt(point), t_s_);
  }

  Eigen::VectorXd predict(const ForwardPoint& point) const override {
    return model_.predict(inputs<double>(point, {}, 0, model_.validityOffset), vehicle_, seen_);
  }

  Eigen::VectorXd differentiate(const ForwardPoint& point, const std::vector<int>& columns,
                                Eigen::MatrixXd& derivative) const override {
    return differentiated(columns, derivative, [&](std::size_t first) {
      return model_.differentiate(inputs<SensorJet>(point, columns, first, model_.validityOffsetJet),
                                  vehicle_, seen_);
    });
  }

  const std::vector<int>& motionColumns() const override {
    static const auto all = [] {
      std::array<std::vector<int>, kInstrumentChannelCount> columns;
      for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = tracedMotion(static_cast<Channel>(i));
      return columns;
    }();
    return all[indexOf(channel_)];
  }

  bool dependsOn(std::size_t effect) const override { return model_.effects[effect]; }

 private:
  template <class T, class Validity>
  ReadingInputs<T> inputs(const ForwardPoint& point, const std::vector<int>& columns, std::size_t first,
                          const Validity& validity) const {
    ReadingInputs<T> in = inputsAt<T>(point, t_s_, columns, first);
    in.world.gravity_odom = vehicle_.gravityOdom();
    if (anyLatency(in.effects.on & model_.effects) || point.knot_latency_s)
      carryOn<T>(in, point, validity(in.effects, t_s_));
    return in;
  }

  const ChannelModel& model_;
  Channel channel_;
  Observation seen_;
  double t_s_;
  const Vehicle& vehicle_;
};

template <class Reader>
std::unique_ptr<ReadingModel> model(Reader reader) {
  return std::make_unique<ModelOf<Reader>>(std::move(reader));
}

}  // namespace

std::unique_ptr<ReadingModel> channelModel(const BatchReading& reading, const Vehicle& vehicle) {
  return std::make_unique<InstrumentReading>(reading, vehicle);
}
std::unique_ptr<ReadingModel> markerModel(const BatchMarker& reading) {
  return model(MarkerReader{reading, reading.t_s});
}
std::unique_ptr<ReadingModel> tiePointModel(const BatchTiePoint& reading) {
  const SeenByBoth seen{reading.cameras, reading.point.pixels, reading.point.sigma_px};
  return model(TiePointReader{seen, contradictionSense(seen, reading.T_left_right), reading.t_s});
}
std::unique_ptr<ReadingModel> patchModel(const ImagePatch& reading, const Vehicle& vehicle) {
  return model(PatchReader{reading, reading.t_s, reading.colours(), vehicle.lamps});
}
std::unique_ptr<ReadingModel> blurModel(const MarkerBlur& reading) {
  return model(BlurReader{reading, reading.t_s});
}
std::unique_ptr<ReadingModel> specksModel(const ImageSpecks& reading) {
  return model(SpecksReader{reading, reading.t_s});
}
std::unique_ptr<ReadingModel> textureModel(const ImageTexture& reading) {
  return model(TextureReader{reading, reading.t_s});
}
std::unique_ptr<ReadingModel> accelerationModel(double t_s) { return model(AccelerationReader{t_s}); }
std::unique_ptr<ReadingModel> poseModel(const Pose& T_odom_robot, double t_s) {
  return model(PoseReader{T_odom_robot, t_s});
}

}  // namespace fathom
