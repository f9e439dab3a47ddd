// A tractor with two trailers must come 3 m to the side. It cannot move sideways: it drives far ahead and
// backs again. Whether it does depends first on the cost, then on the horizon, then on the method.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <slalom/slalom.hpp>

#include "seeds.hpp"

struct Rig {
  template <class T>
  struct State {
    T x, y, yaw, first, second;  // the tractor's axle, m; yaw angles of tractor and trailers, rad
  };
  static constexpr int inputs = 2;     // speed, m/s; curvature, 1/m
  static constexpr double length = 2;  // m, of each trailer
  double dt = 0.2;                     // s
  std::array<double, 2> input_min{-1, -0.35}, input_max{1, 0.35};
  double goal_y = 3;           // m
  double stage_weight = 0.02;  // of the deviation in each step, beside 5 at the end

  template <class T>
  State<T> step(const State<T>& s, const slalom::Input<T, 2>& u) const {
    const T way = T(dt) * u[0], fold = s.yaw - s.first, second_fold = s.first - s.second;
    return {s.x + way * slalom::cos(s.yaw), s.y + way * slalom::sin(s.yaw), s.yaw + way * u[1],
            s.first + way * T(1 / length) * slalom::sin(fold),
            s.second + way * slalom::cos(fold) * T(1 / length) * slalom::sin(second_fold)};
  }
  template <class T>
  slalom::Cost<T> stage_cost(const State<T>& s, const slalom::Input<T, 2>& u) const {
    const slalom::mask_t<T> folded =
        slalom::abs(s.yaw - s.first) > T(1.2) || slalom::abs(s.first - s.second) > T(1.2);
    const T effort = T(0.01) * (u[0] * u[0] + u[1] * u[1]);
    return {T(dt) * (T(stage_weight) * deviation(s) + effort) + slalom::select(folded, T(100), T(0)), folded};
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(5) * deviation(s);
  }
  /// The squared distance of the last axle from its goal, m^2, with 2 m^2 for each squared radian.
  template <class T>
  T deviation(const State<T>& s) const {
    const T x = s.x - T(length) * (slalom::cos(s.first) + slalom::cos(s.second) - T(2));
    const T y = s.y - T(length) * (slalom::sin(s.first) + slalom::sin(s.second)) - T(goal_y);
    return x * x + y * y + T(2) * (s.yaw * s.yaw + s.first * s.first + s.second * s.second);
  }
};

/// Whether the rig stands within 0.3 m and 0.15 rad of its goal within 60 s.
bool arrives(double stage_weight, slalom::SolverOptions options, std::uint64_t seed) {
  *options.find<std::uint64_t>("seed") = seed;
  slalom::Controller controller{Rig{.stage_weight = stage_weight}, options};
  Rig::State<double> s{};
  for (int k = 0; k < 300; ++k) {
    const auto plan = controller.solve(s, {.elapsed = 0.2});
    s = controller.problem().step(s, plan.inputs[0]);
    const double yaws = std::max({std::abs(s.yaw), std::abs(s.first), std::abs(s.second)});
    if (plan.collided) return false;
    if (yaws < 0.15 && controller.problem().deviation(s) < 0.09) return true;
  }
  return false;
}

int main() {
  const auto count = [](const char* what, double stage_weight, const slalom::SolverOptions& options) {
    const int seeds = succeeded([&](std::uint64_t seed) { return arrives(stage_weight, options, seed); });
    std::printf("%s: %d of 20 seeds\n", what, seeds);
    return seeds;
  };
  count("svg_mppi, 15 s, stage weight 1", 1, slalom::SvgMppiOptions{.horizon = 75});
  count("svg_mppi, 5 s, stage weight 0.02", 0.02, slalom::SvgMppiOptions{.horizon = 25});
  count("svg_mppi, 10 s, stage weight 0.02", 0.02, slalom::SvgMppiOptions{.horizon = 50});
  const int arrived = count("svg_mppi, 15 s, stage weight 0.02", 0.02, slalom::SvgMppiOptions{.horizon = 75});
  count("icem, 15 s, stage weight 0.02", 0.02, slalom::IcemOptions{.horizon = 75});
  count("mppi, 15 s, stage weight 0.02", 0.02, slalom::MppiOptions{.horizon = 75});
  count("cem, 15 s, stage weight 0.02", 0.02, slalom::CemOptions{.horizon = 75});
  return arrived >= 16 ? 0 : 1;
}
