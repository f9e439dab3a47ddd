#include "vehicle/racing/banded_matrix.hpp"

namespace slalom::vehicle::detail {

bool BandedMatrix::factorise(double shift) {
  for (int i = 0; i < size_; ++i) {
    const int first = std::max(0, i - band_);
    double pivot = at(i, i) + shift;
    for (int j = first; j < i; ++j) {
      double sum = at(i, j);
      for (int k = std::max(first, j - band_); k < j; ++k) sum -= at(i, k) * at(j, k);
      at(i, j) = sum;  // L D, divided by D below
    }
    for (int j = first; j < i; ++j) {
      const double scaled = at(i, j) / at(j, j);
      pivot -= scaled * at(i, j);
      at(i, j) = scaled;
    }
    if (!(pivot > 0)) return false;
    at(i, i) = pivot;
  }
  return true;
}

void BandedMatrix::solve(std::vector<double>& x) const {
  for (int i = 0; i < size_; ++i)
    for (int j = std::max(0, i - band_); j < i; ++j) x[i] -= at(i, j) * x[j];
  for (int i = 0; i < size_; ++i) x[i] /= at(i, i);
  for (int i = size_ - 1; i >= 0; --i)
    for (int j = std::max(0, i - band_); j < i; ++j) x[j] -= at(i, j) * x[i];
}

}  // namespace slalom::vehicle::detail
