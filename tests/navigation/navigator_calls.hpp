#pragma once

#include <optional>

#include "navigation/grids.hpp"
#include "slalom/navigation/navigator.hpp"
#include "support/adversary.hpp"
#include "support/any_options.hpp"
#include "support/promise.hpp"

/// Navigators as state machines: updates with any pose, path and map, and what every command promises.
namespace slalom::navigation {

inline constexpr double period = 0.05;  // s

inline SvgMppiOptions few_samples(const BaseOptions& base) {
  SvgMppiOptions solver = svg_mppi_options(base);
  solver.horizon = 8;
  solver.samples = 32;
  solver.guides.iterations = 1;
  return solver;
}

/// 4 m x 4 m around the origin with a box in it, or any map.
struct Hall {
  Hall() : grid(free_grid(-2, -2, 4, 4)), costmap(grid.width, grid.height, grid.resolution) {
    add(0.5, -0.5, 1, 0.5, maps::Occupancy::occupied);
  }
  explicit Hall(testing::Adversary& adversary)
      : grid{3 + adversary.below(200), 3 + adversary.below(200), adversary.within(0.02, 0.2), {}, {}},
        costmap(grid.width, grid.height, grid.resolution, static_cast<UnknownCells>(adversary.below(2))) {
    grid.origin = {adversary.within(-5, 1), adversary.within(-5, 1), 0};
    grid.cells.assign(grid.width * grid.height, maps::Occupancy::free);
    for (int left = adversary.below(6); left >= 0; --left) {
      const double x = adversary.within(-2, 2), y = adversary.within(-2, 2);
      add(x, y, x + adversary.within(0, 2), y + adversary.within(0, 2),
          static_cast<maps::Occupancy>(adversary.below(3)));
    }
  }
  void add(double x0, double y0, double x1, double y1, maps::Occupancy value) {
    fill(grid, x0, y0, x1, y1, value);
    costmap.update(grid);
  }
  maps::OccupancyGrid grid;
  Costmap costmap;
};

inline Navigator make_navigator(const NavigatorOptions& options, const Costmap& costmap,
                                const Footprint& footprint = Footprint::rectangle(0.3, 0.3, 0.4)) {
  return {footprint, options, few_samples(options.base), costmap};
}

/// Throws Finding unless a base with these limits may be sent this.
inline void check(const NavigationResult& result, const BaseOptions& base, const Velocity& driven) {
  using testing::require;
  const Velocity& v = result.command;
  const auto within = [](double value, double least, double most, double now) {
    return value >= std::min(least, now) && value <= std::max(most, now);  // or it brakes to them
  };
  const double sideways = base.kind == BaseKind::omnidirectional ? base.max_sideways : 0;
  require(within(v.forward, -base.max_reverse, base.max_forward, driven.forward),
          "the speed is within its limits");
  require(within(v.left, -sideways, sideways, sideways > 0 ? driven.left : 0), "the sideways speed is, too");
  require(within(v.turn, -base.max_turn, base.max_turn, driven.turn), "the yaw rate is within its limits");
  require(std::isfinite(result.remaining), "the remaining path is finite");
  for (const maps::Pose& each : result.plan)
    require(std::isfinite(each.x) && std::isfinite(each.y) && std::isfinite(each.yaw), "plans are finite");
  for (const maps::Pose& each : result.path)
    require(std::isfinite(each.x) && std::isfinite(each.y), "the path is finite");
}

/// Sets any path. Throws Finding.
inline void set_any_path(testing::Adversary& adversary, Navigator& navigator, bool hostile) {
  std::vector<maps::Pose> points(adversary.below(12));
  const double reach = adversary.once_in(4) ? 30 : 2;
  const auto value = [&] { return hostile ? adversary.any(-reach, reach) : adversary.within(-reach, reach); };
  for (maps::Pose& point : points) point = {value(), value(), value()};
  const testing::CallLimits limits;
  try {
    navigator.set_path(points);
  } catch (const std::invalid_argument&) {  // none, not finite, or too far away
  }
  limits.check(10);  // 210,000 steps
}

/// One navigator and a few dozen updates. Returns whether it can be made. Throws Finding.
inline bool call_navigator(testing::Adversary& adversary, const Hall& hall, const Footprint& footprint) {
  NavigatorOptions options;
  if (adversary.once_in(3)) testing::draw_options(adversary, options);
  options.base.kind = static_cast<BaseKind>(adversary.below(3));
  options.find_detours = adversary.below(4) != 0;
  options.patience = adversary.within(0, 1);
  options.stuck_after = adversary.within(0.1, 2);
  if (adversary.below(2)) options.time_step = adversary.within(0.001, 1);
  std::optional<Navigator> made;
  try {
    made.emplace(make_navigator(options, hall.costmap, footprint));
  } catch (const std::invalid_argument&) {  // options that do not go together
    return false;
  }
  Navigator& navigator = *made;
  const Costmap other_size(10, 10, 0.1);
  testing::AnyOthers others;
  for (int i = 0; i < 60; ++i) {
    const bool hostile = adversary.once_in(4);
    const auto value = [&](double low, double high) {
      return hostile ? adversary.any(low, high) : adversary.within(low, high);
    };
    if (adversary.once_in(10)) set_any_path(adversary, navigator, hostile);
    if (adversary.once_in(40)) navigator.reset(static_cast<std::uint64_t>(i));
    const maps::Pose pose{value(-2, 2), value(-2, 2), value(-4, 4)};
    const Velocity velocity{value(-1, 1), value(-1, 1), value(-2, 2)};
    const Costmap& costmap = adversary.once_in(20) ? other_size : hall.costmap;
    const double elapsed = value(0, 0.2);
    const auto predicted = others.draw(adversary);
    const testing::CallLimits limits;
    const NavigationResult result = navigator.update(pose, velocity, costmap, elapsed, predicted);
    limits.check();
    check(result, options.base, velocity);
  }
  return true;
}

}  // namespace slalom::navigation
