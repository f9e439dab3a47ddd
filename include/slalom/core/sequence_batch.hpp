#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>

#include "slalom/core/instruction_set.hpp"

namespace slalom {

/// Float32 values that start at a 64-byte boundary, so that a pack never straddles two cache lines. Sizes and
/// indices are signed: an `int` indexes a buffer without a cast.
class AlignedBuffer {
 public:
  AlignedBuffer() = default;
  /// `size` >= 0 values, all 0.
  explicit AlignedBuffer(std::ptrdiff_t size);
  AlignedBuffer(const AlignedBuffer& other);
  /// Takes over the values; the other buffer may only be destroyed or assigned to afterwards.
  AlignedBuffer(AlignedBuffer&&) noexcept = default;
  AlignedBuffer& operator=(const AlignedBuffer& other) { return *this = AlignedBuffer(other); }
  AlignedBuffer& operator=(AlignedBuffer&&) noexcept = default;
  ~AlignedBuffer() = default;

  float* data() noexcept { return data_.get(); }              ///< the first value
  const float* data() const noexcept { return data_.get(); }  ///< the first value
  std::ptrdiff_t size() const noexcept { return size_; }      ///< number of values
  float& operator[](std::ptrdiff_t i) noexcept { return data_[i]; }
  float operator[](std::ptrdiff_t i) const noexcept { return data_[i]; }

 private:
  struct Free {
    void operator()(float* p) const noexcept;
  };
  std::unique_ptr<float[], Free> data_;
  std::ptrdiff_t size_ = 0;
};

/// A batch of control sequences, a structure of arrays with the sample index fastest: [row][sample], where
/// row = step * inputs() + input. Each row is padded to a multiple of `simd::padding` samples, so whole packs
/// may be read and written beyond `samples()`.
///
/// All counts and indices are `int`. Offsets into the storage are computed in `std::ptrdiff_t`, so the number
/// of values may exceed the range of an `int`.
class SequenceBatch {
 public:
  SequenceBatch() = default;
  /// All values 0.
  SequenceBatch(int steps, int inputs, int samples);

  int steps() const noexcept { return steps_; }           ///< steps of a control sequence
  int inputs() const noexcept { return inputs_; }         ///< inputs per step
  int rows() const noexcept { return steps_ * inputs_; }  ///< values of a control sequence
  int samples() const noexcept { return samples_; }       ///< control sequences, without padding
  /// Makes the first `samples` <= `stride()` sequences all that the batch holds. No value moves.
  void set_samples(int samples) noexcept { samples_ = samples; }
  /// The samples at construction with their padding: the distance from one row to the next.
  int stride() const noexcept { return stride_; }

  /// The values of a row, one per sample, without padding.
  std::span<float> operator[](int row) noexcept { return {data(row), count()}; }
  /// The values of a row, one per sample, without padding.
  std::span<const float> operator[](int row) const noexcept { return {data(row), count()}; }

  /// The first of the `stride()` values of a row, for code that works on whole packs.
  float* data(int row = 0) noexcept { return values_.data() + offset(row); }
  /// The first of the `stride()` values of a row, for code that works on whole packs.
  const float* data(int row = 0) const noexcept { return values_.data() + offset(row); }

  /// The first of the `stride()` values of a step and input.
  float* row(int step, int input) noexcept { return data(step * inputs_ + input); }
  /// The first of the `stride()` values of a step and input.
  const float* row(int step, int input) const noexcept { return data(step * inputs_ + input); }

  /// One value.
  float& at(int step, int input, int sample) noexcept { return row(step, input)[sample]; }
  /// One value.
  float at(int step, int input, int sample) const noexcept { return row(step, input)[sample]; }

  /// Copies the control sequence of a sample to `to`, [row], `rows()` values.
  void get_sample(int sample, std::span<float> to) const noexcept;
  /// Replaces the control sequence of a sample by `from`, [row], `rows()` values.
  void set_sample(int sample, std::span<const float> from) noexcept;

 private:
  std::ptrdiff_t offset(int row) const noexcept { return static_cast<std::ptrdiff_t>(row) * stride_; }
  std::size_t count() const noexcept { return static_cast<std::size_t>(samples_); }

  AlignedBuffer values_;
  int steps_ = 0;
  int inputs_ = 0;
  int samples_ = 0;
  int stride_ = 0;
};

/// `samples` rounded up to a multiple of `simd::padding`.
constexpr int padded(int samples) noexcept {
  return (samples + simd::padding - 1) / simd::padding * simd::padding;
}

}  // namespace slalom
