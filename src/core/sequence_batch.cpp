#include "slalom/core/sequence_batch.hpp"

#include <algorithm>

namespace slalom {

namespace {
constexpr std::align_val_t alignment{64};
}

AlignedBuffer::AlignedBuffer(std::ptrdiff_t size)
    : data_(static_cast<float*>(::operator new(
          static_cast<std::size_t>(std::max<std::ptrdiff_t>(size, 1)) * sizeof(float), alignment))),
      size_(size) {
  std::fill_n(data_.get(), size, 0.0f);
}

AlignedBuffer::AlignedBuffer(const AlignedBuffer& other) {
  if (!other.data_) return;
  *this = AlignedBuffer(other.size_);
  std::copy_n(other.data_.get(), size_, data_.get());
}

void AlignedBuffer::Free::operator()(float* p) const noexcept {
  ::operator delete(p, alignment);
}

SequenceBatch::SequenceBatch(int steps, int inputs, int samples)
    : values_(static_cast<std::ptrdiff_t>(steps) * inputs * padded(samples)),
      steps_(steps),
      inputs_(inputs),
      samples_(samples),
      stride_(padded(samples)) {}

void SequenceBatch::get_sample(int sample, std::span<float> to) const noexcept {
  for (int r = 0; r < rows(); ++r) to[r] = data(r)[sample];
}

void SequenceBatch::set_sample(int sample, std::span<const float> from) noexcept {
  for (int r = 0; r < rows(); ++r) data(r)[sample] = from[r];
}

}  // namespace slalom
