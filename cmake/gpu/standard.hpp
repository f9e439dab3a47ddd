#pragma once

/// The standard library for NVRTC, which brings none: what CUDA's own library has, and read-only layouts,
/// those of libstdc++, of what a problem may point to. Every standard header that is included is this file.

#include <cuda/std/__algorithm_>
#include <cuda/std/__new_>
#include <cuda/std/array>
#include <cuda/std/bit>
#include <cuda/std/cmath>
#include <cuda/std/concepts>
#include <cuda/std/cstddef>
#include <cuda/std/cstdint>
#include <cuda/std/cstring>
#include <cuda/std/functional>
#include <cuda/std/initializer_list>
#include <cuda/std/iterator>
#include <cuda/std/limits>
#include <cuda/std/memory>
#include <cuda/std/numbers>
#include <cuda/std/numeric>
#include <cuda/std/optional>
#include <cuda/std/span>
#include <cuda/std/tuple>
#include <cuda/std/type_traits>
#include <cuda/std/utility>
#include <cuda/std/variant>

namespace std {
using namespace cuda::std;
using ::remainder;

template <class T>
struct default_delete {};
template <class T, class = default_delete<T>>
class unique_ptr {
 public:
  using Element = remove_extent_t<T>;
  Element* get() const { return p_; }
  Element& operator[](size_t i) const { return p_[i]; }
  Element& operator*() const { return *p_; }
  Element* operator->() const { return p_; }

 private:
  Element* p_ = nullptr;
};
template <class T>
class shared_ptr : public unique_ptr<T> {
  void* count_ = nullptr;
};

template <class T>
class vector {
  T *begin_ = nullptr, *end_ = nullptr, *full_ = nullptr;

 public:
  vector() = default;
  vector(initializer_list<T>) {}
  explicit vector(size_t, const T& = T()) {}
  T* begin() const { return begin_; }
  T* end() const { return end_; }
  T* data() const { return begin_; }
  T& operator[](size_t i) const { return begin_[i]; }
  T& at(size_t i) const { return begin_[i]; }
  size_t size() const { return static_cast<size_t>(end_ - begin_); }
  bool empty() const { return begin_ == end_; }
  bool operator==(const vector&) const = default;
};

class string {
  char* data_;
  size_t size_;
  char local_[16];

 public:
  string() = default;
  string(const char*) {}
  const char* c_str() const { return data_; }
  friend string operator+(const string& a, const string&) { return a; }
};
template <class T>
string to_string(T) {
  return {};
}
struct string_view {
  size_t size = 0;
  const char* data = nullptr;
  constexpr string_view() = default;
  constexpr string_view(const char* text) : data(text) {}
};
namespace filesystem {
class path;
}

class exception {};
struct logic_error {
  logic_error(const string&) {}
};
using runtime_error = logic_error;
using invalid_argument = logic_error;
using out_of_range = logic_error;
}  // namespace std
