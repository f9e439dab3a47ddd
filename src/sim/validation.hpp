#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

namespace slalom::sim::detail {

[[noreturn]] inline void fail(const std::string& name, const std::string& value, const std::string& rule) {
  throw std::invalid_argument(name + " = " + value + ": must be " + rule);
}

inline void require_finite(const char* name, double value) {
  if (!std::isfinite(value)) fail(name, std::to_string(value), "finite");
}

inline void require_positive(const char* name, double value) {
  if (!(value > 0) || !std::isfinite(value)) fail(name, std::to_string(value), "finite and above 0");
}

inline void require_range(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    fail(name, std::to_string(value), "in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
}

}  // namespace slalom::sim::detail
