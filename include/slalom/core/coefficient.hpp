#pragma once

namespace slalom {

/// A number that a problem multiplies with: kept in double for scalar code and, converted once, in float32
/// for SIMD lanes. A plain `double` member works as well, but is converted anew for every pack it meets.
///
///     T travelled = x.speed * T(time_step_);   // time_step_ is a Coefficient; T float, double or a pack
class Coefficient {
 public:
  /// Rounds `value` once.
  constexpr Coefficient(double value = 0) noexcept : exact_(value), rounded_(static_cast<float>(value)) {}

  /// The exact value.
  constexpr explicit operator double() const noexcept { return exact_; }
  /// The rounded value.
  constexpr explicit operator float() const noexcept { return rounded_; }
  /// The rounded value.
  constexpr float rounded() const noexcept { return rounded_; }

 private:
  double exact_;
  float rounded_;
};

}  // namespace slalom
