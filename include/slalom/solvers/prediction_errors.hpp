#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace slalom {

/// How far the last predictions of a state were from what came. Each error and its opposite is a direction in
/// which the present state may be wrong, too, or the next one.
///
/// No error of a scalar counts more than the second largest of those kept: so a single jump, as of an
/// angle that starts anew at -pi, changes nothing. An error below the resolution of float32, in which
/// rollouts are computed, is none.
class PredictionErrors {
 public:
  static constexpr int kept = 8;  ///< predictions whose errors are kept

  /// Watches states with this number of scalars.
  explicit PredictionErrors(int scalars = 0);

  /// Compares a state with the one that was predicted for it, both [scalar].
  void add(std::span<const double> state, std::span<const double> predicted) noexcept;
  /// Forgets all errors.
  void clear() noexcept;
  /// Number of errors and opposites; 0 while all predictions were exact.
  int count() const noexcept;
  /// Writes to `moved` the state, moved by the error `index` < `count()`. All are [scalar].
  void move(std::span<const double> state, int index, std::span<double> moved) const noexcept;

 private:
  std::vector<double> errors_;  ///< [prediction][scalar]
  std::vector<double> limits_;  ///< greatest |error| that counts, [scalar]
  std::int64_t added_ = 0;
};

}  // namespace slalom
