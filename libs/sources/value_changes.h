#pragma once

#include <array>
#include <concepts>
#include <string>
#include <string_view>
#include <vector>

#include "core/random.h"
#include "recording/instrument_entries.h"

/// Changes of the values in a sample. A landmark comes in two forms of one image: MARKERS (T_odom_robot) and
/// PANEL (T_camera_panel of each panel seen). Both are changed alike: as if the robot stood elsewhere, by an
/// offset and a turn in robot axes,
///
///   T_odom_robot' = T_odom_robot D        T_camera_panel' = (T_robot_camera)^-1 D^-1 T_robot_camera
///   T_camera_panel
///
/// so the pose that a panel implies moves by the same D. Covariances stay as they are: a sensor does not know
/// of its fault.
namespace fathom {

/// The amounts that faults add: one for each value of an instrument that has such a key (ValueText::fault);
/// for landmarks position_m (robot axes) and angle_deg (rotation vector in robot axes).
struct AmountText {
  std::string_view key;
  bool is_scalar = false;
  std::vector<std::string> labels;  ///< of the entries that it concerns
};
const std::vector<AmountText>& amountTexts();

/// How much is added to which value, in its unit and axes. In YAML a number goes for every axis, or [x, y,
/// z].
class Amounts {
 public:
  /// Of a scalar, the first component counts. Throws std::out_of_range where no value has such an amount.
  Vector3d& of(std::string_view key) { return values_.at(placeOf(key)); }
  const Vector3d& of(std::string_view key) const { return values_.at(placeOf(key)); }

  template <class F>
  void fields(F& f, const auto& limit) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const AmountText& text = amountTexts()[i];
      const std::string key(text.key);
      if (text.is_scalar)
        f.amount(key.c_str(), text.labels, values_[i].x(), limit);
      else
        f.amount(key.c_str(), text.labels, values_[i], limit);
    }
  }

 private:
  static std::size_t placeOf(std::string_view key);
  std::vector<Vector3d> values_ = std::vector<Vector3d>(amountTexts().size(), Vector3d::Zero());
};

namespace detail {
/// A range stays above what stands for "no echo".
void add(double& value, const Vector3d& amount, const ValueText& text);
void add(Vector3d& value, const Vector3d& amount, const ValueText& text);
/// Degrees, in its own axes.
void add(Matrix3d& value, const Vector3d& amount_deg, const ValueText& text);
/// D from an offset and a rotation vector; none where both are zero, which then changes no digit.
void moveRobot(Sample& sample, const Vector3d& offset_m, const Vector3d& turn_rad);
}  // namespace detail

/// Adds change(amount) to every value; `change` is a Vector3d of a Vector3d, called in the order of an
/// instrument's values, however large they are, once for each value (of a scalar, its first component
/// counts).
template <std::invocable<Vector3d> Change>
void addTo(Sample& sample, const Amounts& amounts, Change change) {
  bool is_instruments = false;
  withInstrument(sample, [&]<class Instrument>(auto& entry, const Instance&) {
    is_instruments = true;
    Instrument::forEachValue(entry, [&](int k, auto* value) {
      const ValueText& text = Instrument::values[static_cast<std::size_t>(k)];
      if (text.fault.empty()) return;
      Vector3d amount = amounts.of(text.fault);
      if (text.kind == ValueText::Kind::scalar) amount.tail<2>().setZero();
      const Vector3d changed = change(amount);
      if (value != nullptr) detail::add(*value, changed, text);
    });
  });
  if (is_instruments) return;
  const Vector3d offset = change(amounts.of("position_m")), turn = change(amounts.of("angle_deg"));
  detail::moveRobot(sample, offset, turn * radians(1));
}

/// What corrupted values look like.
enum class Garbage {
  nan,   ///< not a number, all of them
  huge,  ///< +-1e12 in the value's unit; an attitude at random
  wild,  ///< at random, within what the sensor could read: see value_changes.cpp
};
inline constexpr std::array<std::string_view, 3> kGarbageNames{"nan", "huge", "wild"};

/// Replaces all values that are there. Landmarks are moved as above, by a D of garbage.
void replaceValues(Sample& sample, Garbage garbage, Random& random);

/// True for the sensors whose samples have values that the above can change.
bool hasValues(const std::string& label);

}  // namespace fathom
