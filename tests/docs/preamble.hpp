// Names that code blocks of the documentation use and that a reader brings along.
#include <array>
#include <cstdint>
#include <memory>

#include "slalom/maps/ros_map.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/slalom.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace {

/// A value of whatever type is asked for.
struct Anything {
  template <class T>
  operator T() const {
    return {};
  }
};

[[maybe_unused]] constexpr Anything x{};
[[maybe_unused]] constexpr double steer = 0, speed = 0;
[[maybe_unused]] constexpr std::uint64_t seed = 0;

template <class Command>
void apply(const Command&) {}

}  // namespace
