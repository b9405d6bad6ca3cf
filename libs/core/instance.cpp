#include "core/instance.h"

#include <algorithm>
#include <cctype>

#include "core/fingerprint.h"

namespace fathom {

std::optional<Instance> Instance::named(std::string_view name) {
  const auto may_be = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  if (name.empty() || name.size() > kLongest || name == kFirst) return {};
  if (!std::all_of(name.begin(), name.end(), may_be)) return {};
  Instance instance;
  std::copy(name.begin(), name.end(), instance.name_.begin());
  return instance;
}

std::optional<Instance> Instance::of(std::string_view text, std::string_view base) {
  if (text == base) return Instance();  // as nearly always
  if (baseOf(text) != base) return {};
  return named(text.substr(base.size() + 1));
}

Instance Instance::of(std::string_view label) { return of(label, baseOf(label)).value_or(Instance()); }

std::string Instance::label(std::string_view base) const {
  std::string text(base);
  if (!isFirst()) text.append(".").append(name());
  return text;
}

std::uint64_t Instance::number() const { return isFirst() ? 0 : Fingerprint().add(name()).value(); }

std::string_view baseOf(std::string_view label) {
  const auto dot = label.find('.');
  const bool is_instance = dot != std::string_view::npos && Instance::named(label.substr(dot + 1));
  return is_instance ? label.substr(0, dot) : label;
}

}  // namespace fathom
