#pragma once

#include <cstddef>

namespace fathom {

/// While it lives, this thread's `new`, and MRPT's matrices, may take so many bytes in all, and OpenCV's
/// images so many (what is given back meanwhile does not count); what would be more throws std::bad_alloc.
/// For code of others that makes room for whatever length a file states, before it looks whether so much
/// follows. Not nested.
///
/// Programs that link this get an `operator new` and an mrpt::aligned_malloc() of ours, unless they have some
/// of their own (ours are weak): then nothing is limited.
class AllocationLimit {
 public:
  AllocationLimit(std::size_t bytes, std::size_t image_bytes);
  ~AllocationLimit();
  AllocationLimit(const AllocationLimit&) = delete;
  AllocationLimit& operator=(const AllocationLimit&) = delete;
};

}  // namespace fathom
