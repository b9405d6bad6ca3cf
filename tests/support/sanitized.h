#pragma once

namespace fathom::test {

/// Whether sanitizers watch, under which a diagnosis takes minutes and freed memory is kept.
#ifdef FATHOM_SANITIZE
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

}  // namespace fathom::test
