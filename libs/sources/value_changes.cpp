#include "sources/value_changes.h"

#include <algorithm>
#include <limits>

namespace fathom {
namespace {

/// How far landmarks are moved by garbage.
constexpr double kWildPosition_m = 10.0, kWildAngle_rad = 2.0;
constexpr double kHuge = 1e12;

/// Draws garbage values.
struct GarbageDraw {
  Garbage kind;
  Random& random;

  double value(double low, double high) const {
    const double wild = random.uniform(low, high);
    if (kind == Garbage::nan) return std::numeric_limits<double>::quiet_NaN();
    if (kind == Garbage::huge) return wild < 0.5 * (low + high) && low < 0 ? -kHuge : kHuge;
    return wild;
  }
  Vector3d vector(double low, double high) const {
    const double x = value(low, high), y = value(low, high), z = value(low, high);
    return {x, y, z};
  }
  Matrix3d rotation() const {
    const Vector3d axis = random.normal3().normalized();
    const Matrix3d R = expSO3<double>(random.uniform(0, kWildAngle_rad) * axis);
    return kind == Garbage::nan ? Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN()) : R;
  }
};

void replace(double& value, const ValueText& text, const GarbageDraw& draw) {
  if (!text.fault.empty()) value = draw.value(text.wild_low, text.wild_high);
}
void replace(Vector3d& value, const ValueText& text, const GarbageDraw& draw) {
  value = draw.vector(text.wild_low, text.wild_high);
}
void replace(Matrix3d& value, const ValueText&, const GarbageDraw& draw) { value = draw.rotation(); }

void replaceInLandmark(Sample& sample, const GarbageDraw& draw) {
  const Vector3d offset = draw.vector(-kWildPosition_m, kWildPosition_m);
  const Vector3d turn = logSO3<double>(GarbageDraw{Garbage::wild, draw.random}.rotation());
  detail::moveRobot(sample, offset, turn);
}

}  // namespace

namespace detail {

void add(double& value, const Vector3d& amount, const ValueText& text) {
  if (amount.x() == 0) return;
  value += amount.x();
  if (text.least > 0) value = std::max(value, text.least);
}
void add(Vector3d& value, const Vector3d& amount, const ValueText& text) {
  if (text.kind != ValueText::Kind::geodetic) {
    value += amount;
  } else if (!amount.isZero(0)) {
    const Geodetic moved = geodetic(amount, {value.x(), value.y(), value.z()});
    value = {moved.latitude_deg, moved.longitude_deg, moved.height_m};
  }
}
void add(Matrix3d& value, const Vector3d& amount_deg, const ValueText&) {
  if (!amount_deg.isZero(0)) value *= expSO3<double>(amount_deg * radians(1));
}

void moveRobot(Sample& sample, const Vector3d& offset_m, const Vector3d& turn_rad) {
  if (offset_m.isZero(0) && turn_rad.isZero(0)) return;
  const Pose D{expSO3<double>(turn_rad), offset_m};
  if (auto* pose = std::get_if<PoseSample>(&sample.reading)) {
    pose->T_odom_robot.mean = pose->T_odom_robot.mean * D;
  } else if (auto* panels = std::get_if<PanelSample>(&sample.reading)) {
    const Pose change = panels->T_robot_camera.inverse() * D.inverse() * panels->T_robot_camera;
    for (SeenPanel& seen : panels->panels) seen.T_camera_panel.pose = change * seen.T_camera_panel.pose;
  }
}

}  // namespace detail

void replaceValues(Sample& sample, Garbage garbage, Random& random) {
  const GarbageDraw draw{garbage, random};
  if (!isOfInstrument(sample)) return replaceInLandmark(sample, draw);
  withInstrument(sample, [&]<class Instrument>(auto& entry, const Instance&) {
    Instrument::forEachValue(entry, [&](int k, auto* value) {
      if (value != nullptr) replace(*value, Instrument::values[static_cast<std::size_t>(k)], draw);
    });
  });
}

const std::vector<AmountText>& amountTexts() {
  static const std::vector<AmountText> texts = [] {
    std::vector<AmountText> all;
    const auto concern = [&](std::string_view key, bool is_scalar, const char* label) {
      auto found = std::find_if(all.begin(), all.end(), [&](const AmountText& t) { return t.key == key; });
      if (found == all.end()) found = all.insert(all.end(), {key, is_scalar, {}});
      found->labels.emplace_back(label);
    };
    forEachInstrument([&]<class Instrument>() {
      for (const ValueText& value : Instrument::values)
        if (!value.fault.empty())
          concern(value.fault, value.kind == ValueText::Kind::scalar, Instrument::label);
    });
    for (const char* label : {labels::kMarkers, labels::kPanel}) {
      concern("position_m", false, label);
      concern("angle_deg", false, label);
    }
    return all;
  }();
  return texts;
}

std::size_t Amounts::placeOf(std::string_view key) {
  const auto& texts = amountTexts();
  return static_cast<std::size_t>(
      std::find_if(texts.begin(), texts.end(), [&](const AmountText& t) { return t.key == key; }) -
      texts.begin());
}

bool hasValues(const std::string& label) {
  return std::any_of(amountTexts().begin(), amountTexts().end(), [&](const AmountText& text) {
    return std::find(text.labels.begin(), text.labels.end(), label) != text.labels.end();
  });
}

}  // namespace fathom
