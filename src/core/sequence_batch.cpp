#include "slalom/core/sequence_batch.hpp"

#include <algorithm>

namespace slalom {

namespace {
constexpr std::align_val_t alignment{64};
}

AlignedBuffer::AlignedBuffer(std::size_t size)
    : data_(static_cast<float*>(::operator new(std::max<std::size_t>(size, 1) * sizeof(float), alignment))),
      size_(size) {
  std::fill_n(data_.get(), size, 0.0f);
}

void AlignedBuffer::Free::operator()(float* p) const noexcept {
  ::operator delete(p, alignment);
}

SequenceBatch::SequenceBatch(int steps, int inputs, int samples)
    : values_(static_cast<std::size_t>(steps) * static_cast<std::size_t>(inputs) *
              static_cast<std::size_t>(padded(samples))),
      steps_(steps),
      inputs_(inputs),
      samples_(samples),
      stride_(padded(samples)) {}

}  // namespace slalom
