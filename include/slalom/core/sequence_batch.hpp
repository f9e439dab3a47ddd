#pragma once

#include <cstddef>
#include <memory>
#include <new>

#include "slalom/core/simd.hpp"

namespace slalom {

/// Float32 values on a 64-byte border, so that a pack never straddles two cache lines.
class AlignedBuffer {
 public:
  AlignedBuffer() = default;
  explicit AlignedBuffer(std::size_t size);

  float* data() noexcept { return data_.get(); }
  const float* data() const noexcept { return data_.get(); }
  std::size_t size() const noexcept { return size_; }
  float& operator[](std::size_t i) noexcept { return data_[static_cast<std::ptrdiff_t>(i)]; }
  float operator[](std::size_t i) const noexcept { return data_[static_cast<std::ptrdiff_t>(i)]; }

 private:
  struct Free {
    void operator()(float* p) const noexcept;
  };
  std::unique_ptr<float[], Free> data_;
  std::size_t size_ = 0;
};

/// A batch of control sequences, structure of arrays with the sample fastest: [step][input][sample]. The
/// samples are padded to a multiple of `simd::padding`, so whole packs may be read and written past
/// `samples()`.
class SequenceBatch {
 public:
  SequenceBatch() = default;
  /// All values 0.
  SequenceBatch(int steps, int inputs, int samples);

  int steps() const noexcept { return steps_; }
  int inputs() const noexcept { return inputs_; }
  int samples() const noexcept { return samples_; }
  /// Samples with their padding: the distance from one (step, input) row to the next.
  int stride() const noexcept { return stride_; }

  float* row(int step, int input) noexcept { return values_.data() + offset(step, input); }
  const float* row(int step, int input) const noexcept { return values_.data() + offset(step, input); }
  float& at(int step, int input, int sample) noexcept { return row(step, input)[sample]; }
  float at(int step, int input, int sample) const noexcept { return row(step, input)[sample]; }

 private:
  std::ptrdiff_t offset(int step, int input) const noexcept {
    return (static_cast<std::ptrdiff_t>(step) * inputs_ + input) * stride_;
  }

  AlignedBuffer values_;
  int steps_ = 0;
  int inputs_ = 0;
  int samples_ = 0;
  int stride_ = 0;
};

/// `samples` rounded up to whole paddings.
constexpr int padded(int samples) noexcept {
  return (samples + simd::padding - 1) / simd::padding * simd::padding;
}

}  // namespace slalom
