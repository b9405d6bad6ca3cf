#include "core/stable_sort.h"

#include <algorithm>
#include <numeric>

namespace fathom {

std::vector<std::size_t> detail::stableOrder(std::size_t count, const void* values,
                                             bool (*before)(const void* values, std::size_t a,
                                                            std::size_t b)) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return before(values, a, b); });
  return order;
}

}  // namespace fathom
