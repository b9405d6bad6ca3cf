#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace fathom {

/// Which of several instruments of one kind on a vehicle: what stands behind the dot of its entries' label
/// ("DVL.2", "CAMERA.port") and of its section in the vehicle file ("dvl.2"). The first, or only one, has
/// none.
class Instance {
 public:
  static constexpr std::size_t kLongest = 15;
  static constexpr std::string_view kFirst = "first";  ///< whoever must name it

  constexpr Instance() = default;
  /// 1 to 15 letters, digits, `_` or `-`, but not `first`; nothing of what is no such name.
  static std::optional<Instance> named(std::string_view name);
  /// Of the one that a label "BASE" or "BASE.NAME" is about, whatever the base.
  static Instance of(std::string_view label);
  /// Of the one that "BASE" or "BASE.NAME" is about; nothing where the text is of another base, or no such
  /// name.
  static std::optional<Instance> of(std::string_view text, std::string_view base);

  bool isFirst() const { return name_[0] == '\0'; }
  /// Empty: the first.
  std::string_view name() const { return name_.data(); }
  /// "DVL" of the first, "DVL.2" of another.
  std::string label(std::string_view base) const;
  /// Zero of the first; of others as good as never the same.
  std::uint64_t number() const;

  friend auto operator<=>(const Instance&, const Instance&) = default;

 private:
  std::array<char, kLongest + 1> name_{};
};

/// What stands before the dot: "DVL" of "DVL.2". All of it where no instance's name stands behind.
std::string_view baseOf(std::string_view label);

}  // namespace fathom
