#include "estimation/readings.h"

#include <ceres/jet.h>

#include <algorithm>

#include "estimation/reading_inputs.h"
#include "imaging/camera_geometry.h"
#include "imaging/two_views.h"
#include "sensors/models.h"

namespace fathom {
namespace {

template <class... Stages>
struct StageList {
  template <class Effect>
  static constexpr bool has() {
    return (std::is_same_v<typename Effect::template Stage<double>, Stages> || ...);
  }
};

/// Columns of three each, by their first.
std::vector<int> triples(std::initializer_list<int> firsts) {
  std::vector<int> columns;
  for (const int first : firsts)
    for (int i = 0; i < 3; ++i) columns.push_back(first + i);
  return columns;
}

// Each sensor: when it is valid, what acts on it, what it depends on, and the call of its model.

struct GyroReader {
  static constexpr Sensor kSensor = Sensor::ins;
  using Stages =
      StageList<Mounting<double, Sensor::ins>, ValidityOffset<double, Sensor::ins>, GyroReading<double>>;
  static std::vector<int> motion() { return triples({kOrientationColumn, kRateColumn}); }
  Pose T_robot_ins;
  double t_s;
  template <class T>
  Vector3<T> predict(const ReadingInputs<T>& in) const {
    return predictGyro(in.state, T_robot_ins, in.effects, t_s);
  }
};

struct ForceReader {
  static constexpr Sensor kSensor = Sensor::ins;
  using Stages = StageList<Mounting<double, Sensor::ins>, ValidityOffset<double, Sensor::ins>,
                           AccelerometerReading<double>>;
  static std::vector<int> motion() {
    return triples({kOrientationColumn, kAccelerationColumn, kRateColumn, kRateDerivativeColumn});
  }
  Pose T_robot_ins;
  double t_s;
  Vector3d gravity_odom;
  template <class T>
  Vector3<T> predict(const ReadingInputs<T>& in) const {
    return predictSpecificForce(in.state, World<T>{gravity_odom, T(0)}, T_robot_ins, in.effects, t_s);
  }
};

struct AttitudeReader {
  static constexpr Sensor kSensor = Sensor::ins;
  using Stages = StageList<Mounting<double, Sensor::ins>, ValidityOffset<double, Sensor::ins>>;
  static std::vector<int> motion() { return triples({kOrientationColumn}); }
  Pose T_robot_ins;
  double t_s;
  Matrix3d R_odom_about;
  template <class T>
  Vector3<T> predict(const ReadingInputs<T>& in) const {
    return logSO3<T>(R_odom_about.transpose().cast<T>() *
                     predictAttitude(in.state, T_robot_ins, in.effects, t_s));
  }
};

struct DvlReader {
  static constexpr Sensor kSensor = Sensor::dvl;
  using Stages =
      StageList<Mounting<double, Sensor::dvl>, ValidityOffset<double, Sensor::dvl>, DvlVelocity<double>>;
  static std::vector<int> motion() { return triples({kOrientationColumn, kVelocityColumn, kRateColumn}); }
  Pose T_robot_dvl;
  double t_s;
  template <class T>
  Vector3<T> predict(const ReadingInputs<T>& in) const {
    return predictDvlVelocity(in.state, T_robot_dvl, in.effects, t_s);
  }
};

struct PressureReader {
  static constexpr Sensor kSensor = Sensor::depth;
  using Stages = StageList<Mounting<double, Sensor::depth>, ValidityOffset<double, Sensor::depth>,
                           SeaWater<double>, PressureReading<double>>;
  static std::vector<int> motion() { return triples({kPositionColumn, kOrientationColumn}); }
  DepthSheet sheet;
  Pose T_robot_depth;
  double t_s;
  Vector3d gravity_odom;
  template <class T>
  Eigen::Matrix<T, 1, 1> predict(const ReadingInputs<T>& in) const {
    return Eigen::Matrix<T, 1, 1>(
        predictPressure(in.state, World<T>{gravity_odom, T(0)}, sheet, T_robot_depth, in.effects, t_s));
  }
};

struct UsblReader {
  static constexpr Sensor kSensor = Sensor::depth;
  using Stages = StageList<>;
  static std::vector<int> motion() { return triples({kPositionColumn, kOrientationColumn}); }
  Pose T_robot_usbl;
  double t_s;
  template <class T>
  Vector3<T> predict(const ReadingInputs<T>& in) const {
    return predictUsbl(in.state, T_robot_usbl);
  }
};

struct MarkerReader {
  static constexpr Sensor kSensor = Sensor::camera;
  using Stages = StageList<Mounting<double, Sensor::camera>, ValidityOffset<double, Sensor::camera>,
                           FlatPort<double>, Intrinsics<double>, Shutter<double>, MarkerPlacement<double>,
                           PanelPlacement<double>, ResponseCurve<double>>;
  static std::vector<int> motion() { return triples({kPositionColumn, kOrientationColumn}); }
  BatchMarker seen;
  double t_s;
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
  static constexpr Sensor kSensor = Sensor::camera;
  using Stages = StageList<FlatPort<double>, Intrinsics<double>>;
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
  static constexpr Sensor kSensor = Sensor::camera;
  using Stages = StageList<Mounting<double, Sensor::camera>, ValidityOffset<double, Sensor::camera>,
                           PanelPlacement<double>, SceneLight<double>, WaterRay<double>,
                           PixelResponse<double>, ResponseCurve<double>>;
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
  static constexpr Sensor kSensor = Sensor::camera;
  using Stages = StageList<ExposureTime<double>>;
  static std::vector<int> motion() { return {}; }
  MarkerBlur seen;
  double t_s;
  template <class T>
  Vector3<T> predict(const ReadingInputs<T>& in) const {
    return predictBlur(in.state, in.panel, seen, in.flaws[kLensBlur], in.effects, t_s);
  }
};

struct SpecksReader {
  static constexpr Sensor kSensor = Sensor::camera;
  using Stages = StageList<SuspendedParticles<double>>;
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

struct AccelerationReader {
  static constexpr Sensor kSensor = Sensor::ins;
  using Stages = StageList<>;
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
  static constexpr Sensor kSensor = Sensor::ins;
  using Stages = StageList<>;
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

template <class Reader>
class ModelOf final : public ReadingModel {
 public:
  explicit ModelOf(Reader reader) : reader_(std::move(reader)) {}

  double validity_s(const ForwardPoint& point) const override {
    EffectParameters<double> effects;
    effects.values = point.effects;
    effects.on = point.on;
    return kMayBeLate ? validityOffset<Reader::kSensor>(effects, reader_.t_s) : 0.0;
  }

  Eigen::VectorXd predict(const ForwardPoint& point) const override {
    return reader_.predict(inputs<double>(point, {}, 0));
  }

  Eigen::VectorXd differentiate(const ForwardPoint& point, const std::vector<int>& columns,
                                Eigen::MatrixXd& derivative) const override {
    constexpr int kStride = 8;  // columns at once
    using Jet = ceres::Jet<double, kStride>;
    Eigen::VectorXd prediction;
    for (std::size_t first = 0; first < columns.size(); first += kStride) {
      const auto jets = reader_.predict(inputs<Jet>(point, columns, first));
      if (first == 0) {
        prediction.resize(jets.size());
        derivative.resize(jets.size(), static_cast<Eigen::Index>(columns.size()));
        for (Eigen::Index i = 0; i < jets.size(); ++i) prediction[i] = jets[i].a;
      }
      const auto count =
          std::min<Eigen::Index>(kStride, std::ssize(columns) - static_cast<Eigen::Index>(first));
      for (Eigen::Index i = 0; i < jets.size(); ++i)
        derivative.row(i).segment(static_cast<Eigen::Index>(first), count) =
            jets[i].v.head(count).transpose();
    }
    return prediction;
  }

  const std::vector<int>& motionColumns() const override {
    static const std::vector<int> columns = Reader::motion();
    return columns;
  }

  bool dependsOn(std::size_t effect) const override {
    static const std::bitset<kEffectCount> mask = [] {
      std::bitset<kEffectCount> effects;
      forEachEffect([&]<class Effect>() {
        if (Reader::Stages::template has<Effect>()) effects.set(kEffectIndex<Effect>);
      });
      return effects;
    }();
    return mask[effect];
  }

 private:
  /// Whether an effect on this reading may say that it is late.
  static constexpr bool kMayBeLate = !std::is_same_v<typename Reader::Stages, StageList<>>;

  template <class T>
  ReadingInputs<T> inputs(const ForwardPoint& point, const std::vector<int>& columns,
                          std::size_t first) const {
    ReadingInputs<T> in = inputsAt<T>(point, reader_.t_s, columns, first);
    if constexpr (kMayBeLate) carryOn<T, Reader::kSensor>(in, point, reader_.t_s);
    return in;
  }

  Reader reader_;
};

template <class Reader>
std::unique_ptr<ReadingModel> model(Reader reader) {
  return std::make_unique<ModelOf<Reader>>(std::move(reader));
}

}  // namespace

std::unique_ptr<ReadingModel> gyroModel(const InsBin& bin) {
  return model(GyroReader{bin.T_robot_ins, bin.t_s()});
}
std::unique_ptr<ReadingModel> forceModel(const InsBin& bin, const Vehicle& vehicle) {
  return model(ForceReader{bin.T_robot_ins, bin.t_s(), vehicle.gravityOdom()});
}
std::unique_ptr<ReadingModel> attitudeModel(const InsBin& bin) {
  return model(AttitudeReader{bin.T_robot_ins, bin.t_s(), bin.about});
}
std::unique_ptr<ReadingModel> dvlModel(const BatchDvl& reading) {
  return model(DvlReader{reading.T_robot_dvl, reading.t_s});
}
std::unique_ptr<ReadingModel> pressureModel(const BatchPressure& reading, const Vehicle& vehicle) {
  return model(
      PressureReader{vehicle.depth.value(), reading.T_robot_depth, reading.t_s, vehicle.gravityOdom()});
}
std::unique_ptr<ReadingModel> usblModel(const BatchUsbl& reading, const Vehicle& vehicle) {
  return model(UsblReader{vehicle.usbl ? vehicle.usbl->T_robot_usbl : Pose{}, reading.t_s});
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
std::unique_ptr<ReadingModel> accelerationModel(double t_s) { return model(AccelerationReader{t_s}); }
std::unique_ptr<ReadingModel> poseModel(const Pose& T_odom_robot, double t_s) {
  return model(PoseReader{T_odom_robot, t_s});
}

}  // namespace fathom
