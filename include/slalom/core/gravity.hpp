#pragma once

namespace slalom {

inline constexpr double gravity = 9.81;  ///< m/s^2, acceleration of free fall

}  // namespace slalom
