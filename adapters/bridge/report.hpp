#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

/// What a node says of its state, about once per second.
namespace slalom_bridge {

/// As in diagnostic_msgs/DiagnosticStatus.
enum class Level { ok = 0, warning = 1, error = 2 };

struct Report {
  Level level = Level::ok;
  std::string about;    ///< what is reported on
  std::string message;  ///< the state in a few words
  std::vector<std::pair<std::string, std::string>> values;

  template <class Value>
  void add(const std::string& key, const Value& value) {
    std::ostringstream text;
    text << value;
    values.emplace_back(key, text.str());
  }
};

/// The latest values of a quantity, for percentiles of them. Adding one does not allocate.
class RecentValues {
 public:
  void add(double value) {
    values_[next_] = value;
    next_ = (next_ + 1) % capacity;
    count_ = std::min(count_ + 1, capacity);
  }
  void clear() { count_ = next_ = 0; }
  std::size_t count() const { return count_; }

  /// The least value that at least the fraction `share` (0 .. 1) of the values does not exceed; 0 if there is
  /// none.
  double percentile(double share) const {
    if (count_ == 0) return 0;
    std::array<double, capacity> sorted = values_;
    const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(count_);
    const double rank = std::max(0.0, std::min(share, 1.0)) * static_cast<double>(count_);
    const auto whole = static_cast<std::size_t>(rank);
    const std::size_t above = whole + (static_cast<double>(whole) < rank ? 1 : 0);
    const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(above, 1) - 1);
    std::nth_element(sorted.begin(), nth, end);
    return *nth;
  }

 private:
  static constexpr std::size_t capacity = 400;  ///< ten seconds at 40 Hz

  std::array<double, capacity> values_{};
  std::size_t count_ = 0, next_ = 0;
};

}  // namespace slalom_bridge
