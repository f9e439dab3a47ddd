#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "slalom/core/sequence_batch.hpp"
#include "solvers/kernels/kernels.hpp"

namespace slalom::detail {

/// The rows of a batch, for the kernels.
inline Rows<float> rows_of(SequenceBatch& batch) noexcept {
  return {batch.data(), batch.stride(), batch.rows()};
}

/// A row-major matrix. Indices are `int`; offsets are computed in `std::ptrdiff_t`.
template <class T>
class Matrix {
 public:
  Matrix() = default;
  /// All entries 0.
  Matrix(int rows, int columns) : columns_(columns), values_(rows * columns_) {}

  /// The first entry of a row.
  T* operator[](int row) noexcept { return values_.data() + row * columns_; }
  /// The first entry of a row.
  const T* operator[](int row) const noexcept { return values_.data() + row * columns_; }

  /// All entries, row after row.
  std::vector<T>& values() noexcept { return values_; }
  /// All entries, row after row.
  const std::vector<T>& values() const noexcept { return values_; }

  void swap(Matrix& other) noexcept {
    std::swap(columns_, other.columns_);
    values_.swap(other.values_);
  }

 private:
  std::ptrdiff_t columns_ = 0;
  std::vector<T> values_;
};

}  // namespace slalom::detail
