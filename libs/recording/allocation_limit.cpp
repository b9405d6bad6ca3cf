#include "recording/allocation_limit.h"

#include <mrpt/core/aligned_allocator.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <new>
#include <opencv2/core/mat.hpp>
#include <span>

// Programs may have their own; the address sanitizer's, which are weak themselves, are not to be preferred.
#ifdef FATHOM_SANITIZE
#define FATHOM_REPLACED
#else
#define FATHOM_REPLACED [[gnu::weak]]
#endif

namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
thread_local std::size_t bytes_left = kUnlimited, image_bytes_left = kUnlimited;

void charge(std::size_t& left, std::size_t bytes) {
  if (left == kUnlimited) return;
  if (bytes > left) throw std::bad_alloc();
  left -= bytes;
}

/// What `get` gives, by the rules of `operator new`.
template <class Get>
void* allocate(std::size_t bytes, Get get) {
  charge(bytes_left, bytes);
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

template <class Allocate>
void* orNull(Allocate allocate) noexcept {
  try {
    return allocate();
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

/// What an image's pixels take, or more than any image does.
std::size_t imageBytes(int dims, const int* sizes, int type) {
  std::size_t bytes = static_cast<std::size_t>(CV_ELEM_SIZE(type));
  for (const int size : std::span(sizes, static_cast<std::size_t>(dims)))
    if (__builtin_mul_overflow(bytes, static_cast<std::size_t>(std::max(size, 0)), &bytes)) return kUnlimited;
  return bytes;
}

/// OpenCV's own for images, behind the limit.
class LimitedImages : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, std::size_t* step,
                         cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    if (data == nullptr) charge(image_bytes_left, imageBytes(dims, sizes, type));
    return own_->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return own_->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override { own_->deallocate(data); }

 private:
  const cv::MatAllocator* own_ = cv::Mat::getStdAllocator();
};

/// Images are freed by the allocator that they came from, so that this one lives as long as any of them.
void limitImages() {
  static const bool once = [] {
    cv::Mat::setDefaultAllocator(new LimitedImages);
    return true;
  }();
  static_cast<void>(once);
}

using Bytes = std::size_t;
using Aligned = std::align_val_t;
using Nothrow = const std::nothrow_t&;

}  // namespace

// All forms, so that none is left to another allocator, whose memory ours would free.
FATHOM_REPLACED void* operator new(Bytes bytes) { return allocate(bytes); }
FATHOM_REPLACED void* operator new[](Bytes bytes) { return allocate(bytes); }
FATHOM_REPLACED void* operator new(Bytes bytes, Aligned alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment));
}
FATHOM_REPLACED void* operator new[](Bytes bytes, Aligned alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment));
}
FATHOM_REPLACED void* operator new(Bytes bytes, Nothrow) noexcept {
  return orNull([&] { return allocate(bytes); });
}
FATHOM_REPLACED void* operator new[](Bytes bytes, Nothrow) noexcept {
  return orNull([&] { return allocate(bytes); });
}
FATHOM_REPLACED void* operator new(Bytes bytes, Aligned alignment, Nothrow) noexcept {
  return orNull([&] { return allocate(bytes, static_cast<std::size_t>(alignment)); });
}
FATHOM_REPLACED void* operator new[](Bytes bytes, Aligned alignment, Nothrow) noexcept {
  return orNull([&] { return allocate(bytes, static_cast<std::size_t>(alignment)); });
}
FATHOM_REPLACED void operator delete(void* memory) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete[](void* memory) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete(void* memory, Bytes) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete[](void* memory, Bytes) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete(void* memory, Aligned) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete[](void* memory, Aligned) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete(void* memory, Bytes, Aligned) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete[](void* memory, Bytes, Aligned) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete(void* memory, Nothrow) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete[](void* memory, Nothrow) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete(void* memory, Aligned, Nothrow) noexcept { std::free(memory); }
FATHOM_REPLACED void operator delete[](void* memory, Aligned, Nothrow) noexcept { std::free(memory); }

// MRPT's matrices and vectors of floats take their memory here, and write to it even where there was none.
FATHOM_REPLACED void* mrpt::aligned_malloc(std::size_t bytes, std::size_t alignment) {
  return allocate(bytes, alignment);
}

namespace fathom {

AllocationLimit::AllocationLimit(std::size_t bytes, std::size_t image_bytes) {
  limitImages();
  bytes_left = bytes, image_bytes_left = image_bytes;
}
AllocationLimit::~AllocationLimit() { bytes_left = image_bytes_left = kUnlimited; }

}  // namespace fathom
