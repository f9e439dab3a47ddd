#pragma once

#include <iterator>

namespace slalom {

/// Outcome of a solve. Whatever the status, the result holds finite inputs within their bounds.
enum class Status {
  ok,                ///< solved as asked
  deadline,          ///< stopped at the deadline; the result is the best found until then
  all_collided,      ///< every sample collided; the result is the method's answer all the same
  degenerate,        ///< infinite or NaN costs: no usable weights, and the result is the fallback of the
                     ///< method; or the plan has no finite cost
  non_finite_state,  ///< the state given is not finite; nothing was solved, the result repeats the last plan
  invalid_time,  ///< `elapsed` is negative or not finite, or was given without a duration of the problem's
                 ///< steps, or the deadline is not a number; nothing was solved, as above
};

/// The name of a status, as it is written in results.
constexpr const char* name(Status status) noexcept {
  constexpr const char* names[] = {"ok",         "deadline",         "all_collided",
                                   "degenerate", "non_finite_state", "invalid_time"};
  static_assert(std::size(names) == static_cast<int>(Status::invalid_time) + 1);
  return names[static_cast<int>(status)];
}

}  // namespace slalom
