#pragma once

namespace slalom {

constexpr double square(double value) noexcept {
  return value * value;
}

}  // namespace slalom
