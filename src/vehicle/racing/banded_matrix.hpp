#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace slalom::vehicle::detail {

/// A symmetric matrix whose elements are 0 beyond a number of diagonals; the lower half is stored.
class BandedMatrix {
 public:
  /// `band` diagonals below the main one.
  BandedMatrix(int size, int band)
      : size_(size), band_(band), cells_(static_cast<std::size_t>(size) * (band + 1)) {}

  void clear() { std::fill(cells_.begin(), cells_.end(), 0.0); }

  /// The element of a row and a column; row >= column.
  double& at(int row, int column) {
    return cells_[static_cast<std::size_t>(row) * (band_ + 1) + row - column];
  }
  double at(int row, int column) const {
    return cells_[static_cast<std::size_t>(row) * (band_ + 1) + row - column];
  }

  int size() const { return size_; }
  int band() const { return band_; }

  /// Replaces the matrix plus `shift` times the unit matrix by its factors L D L^T. Returns whether it is
  /// positive definite; if not, the content is undefined.
  bool factorise(double shift);

  /// Solves for a right side in place; after factorise().
  void solve(std::vector<double>& x) const;

 private:
  int size_, band_;
  std::vector<double> cells_;
};

}  // namespace slalom::vehicle::detail
