#include "recording/allocation_limit.h"

#include <mrpt/core/aligned_allocator.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <new>

// Programs may have their own; the address sanitizer's, which are weak themselves, are not to be preferred.
#ifdef FATHOM_SANITIZE
#define FATHOM_REPLACED
#else
#define FATHOM_REPLACED [[gnu::weak]]
#endif

namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
thread_local std::size_t bytes_left = kUnlimited;

void charge(std::size_t bytes) {
  if (bytes_left == kUnlimited) return;
  if (bytes > bytes_left) throw std::bad_alloc();
  bytes_left -= bytes;
}

/// What `get` gives, by the rules of `operator new`.
template <class Get>
void* allocate(std::size_t bytes, Get get) {
  charge(bytes);
  for (;;) {
    if (void* memory = get()) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void* allocate(std::size_t bytes) {
  return allocate(bytes, [&] { return std::malloc(bytes > 0 ? bytes : 1); });
}

void* allocate(std::size_t bytes, std::size_t alignment) {
  if (bytes > kUnlimited - alignment) throw std::bad_alloc();
  const std::size_t whole = (std::max(bytes, alignment) + alignment - 1) / alignment * alignment;
  return allocate(bytes, [&] { return std::aligned_alloc(alignment, whole); });
}

}  // namespace

// The array forms and those that do not throw are the standard library's, which call these.
FATHOM_REPLACED void* operator new(std::size_t bytes) { return allocate(bytes); }
FATHOM_REPLACED void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment));
}
FATHOM_REPLACED void operator delete(void* memory) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

// MRPT's matrices and vectors of floats take their memory here, and write to it even where there was none.
FATHOM_REPLACED void* mrpt::aligned_malloc(std::size_t bytes, std::size_t alignment) {
  return allocate(bytes, alignment);
}

namespace fathom {

AllocationLimit::AllocationLimit(std::size_t bytes) { bytes_left = bytes; }
AllocationLimit::~AllocationLimit() { bytes_left = kUnlimited; }

}  // namespace fathom
