#pragma once

#include <vector>

namespace slalom {

/// A vector whose copies keep its capacity, so that what does not allocate with the vector does not allocate
/// with a copy either.
template <class T>
class ReservedVector : public std::vector<T> {
 public:
  using std::vector<T>::vector;
  ReservedVector(const ReservedVector& other) : std::vector<T>() {
    this->reserve(other.capacity());
    this->assign(other.begin(), other.end());
  }
  ReservedVector(ReservedVector&&) noexcept = default;
  ReservedVector& operator=(const ReservedVector& other) { return *this = ReservedVector(other); }
  ReservedVector& operator=(ReservedVector&&) noexcept = default;
  ~ReservedVector() = default;
};

}  // namespace slalom
