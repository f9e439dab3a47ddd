#include "view/session/timeline.hpp"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace slalom::view {

std::size_t allocated_bytes() {
#if defined(__GLIBC__)
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
#else
  return 0;
#endif
}

void DrivenTick::pack(const Packing& packing) {
  if (!packing.pack || is_packed) return;
  frame = shared(packing.pack(*frame));
  is_packed = true;
}

std::shared_ptr<const std::string> DrivenTick::message(const Packing& packing) const {
  return is_packed ? shared(packing.unpack(*frame)) : frame;
}

std::size_t DrivenTick::bytes() const noexcept {
  return sizeof *this + scalars.capacity() + (frame ? frame->capacity() : 0);
}

}  // namespace slalom::view
