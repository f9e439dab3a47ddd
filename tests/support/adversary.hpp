#pragma once

#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <random>
#include <string_view>

namespace slalom::testing {

/// Makes choices and values, some of them at the limits of what a double is: at random, or as the bytes of a
/// fuzzer say.
class Adversary {
 public:
  explicit Adversary(std::uint64_t seed) : random_(seed) {}
  explicit Adversary(std::string_view bytes) : bytes_(bytes), is_random_(false) {}

  /// Whether the bytes are used up; from then on all choices are the first one.
  bool is_done() const { return !is_random_ && bytes_.empty(); }

  int below(int count) {
    return static_cast<int>(draw(count <= 256 ? 1 : 2) % static_cast<std::uint64_t>(count));
  }
  bool once_in(int count) { return below(count) == 0; }
  double within(double low, double high) {
    const double share =
        is_random_ ? static_cast<double>(draw(8) >> 11) * 0x1p-53 : static_cast<double>(draw(2)) / 65536;
    return low + (high - low) * share;
  }
  /// Most often in [low, high]; otherwise any double.
  double any(double low, double high) {
    static constexpr double odd[] = {0.0,  -0.0,   4.9e-324, 1e-310, 1e-40,  1e6,   -1e6,
                                     1e7,  199.0,  4132.0,   -201.0, 1e15,   -1e18, 3.4e38,
                                     1e39, -1e200, -1e300,   1e300,  1.7e308};
    switch (below(10)) {
      case 0:
        return std::numeric_limits<double>::quiet_NaN();
      case 1:
        return below(2) ? INFINITY : -INFINITY;
      case 2:
      case 3:
        return odd[below(static_cast<int>(std::size(odd)))];
      default:
        return within(low, high);
    }
  }

 private:
  std::uint64_t draw(int size) {
    if (is_random_) return random_();
    std::uint64_t value = 0;
    for (; size > 0 && !bytes_.empty(); --size, bytes_.remove_prefix(1))
      value = value << 8 | static_cast<unsigned char>(bytes_.front());
    return value;
  }

  std::mt19937_64 random_;
  std::string_view bytes_;
  bool is_random_ = true;
};

}  // namespace slalom::testing
