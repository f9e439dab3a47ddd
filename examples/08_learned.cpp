// A boat holds its place in a river whose current and drag nobody has modelled. A network has learned them
// from recorded trips: examples/python/08_learned.py trains it and writes examples/learned/boat.npz.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>

#include <slalom/slalom.hpp>

#include "seeds.hpp"

/// A boat with the water that `Water` knows of.
template <class Water>
struct Boat {
  template <class T>
  struct State {
    T x, y, speed_x, speed_y;  // m, m, m/s, m/s; x along the river, y across it
  };
  static constexpr int inputs = 2;  // m/s^2
  double dt = 0.1;                  // s
  double input_min = -2, input_max = 2;
  double goal_y = 2.5;  // m, in the strongest current
  Water water;

  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 2>& u) const {
    const auto speeds = water(x.speed_x, x.speed_y, x.y, u[0], u[1]);
    return {x.x + T(dt) * speeds[0], x.y + T(dt) * speeds[1], speeds[0], speeds[1]};
  }
  template <class T>
  T stage_cost(const State<T>& x, const slalom::Input<T, 2>& u) const {
    return T(dt) * (square_distance(x) + T(0.2) * (x.speed_x * x.speed_x + x.speed_y * x.speed_y) +
                    T(0.02) * (u[0] * u[0] + u[1] * u[1]));
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(2) * square_distance(x);
  }
  template <class T>
  T square_distance(const State<T>& x) const {
    return slalom::square(x.x) + slalom::square(x.y - T(goal_y));
  }
};

/// Speeds after a step, where the water does nothing.
struct NoWater {
  template <class T>
  SLALOM_INLINE_CALLS std::array<T, 2> operator()(const T& speed_x, const T& speed_y, const T&, const T& u_x,
                                                  const T& u_y) const {
    return {speed_x + T(0.1) * u_x, speed_y + T(0.1) * u_y};
  }
};

/// The real water: a current along x that is strongest in the middle, and quadratic drag.
struct River {
  std::array<double, 2> operator()(double speed_x, double speed_y, double y, double u_x, double u_y) const {
    const double across = y - 2.5, relative = speed_x - 1.2 * std::exp(-across * across);
    const double drag = 0.6 * std::hypot(relative, speed_y);
    return {speed_x + 0.1 * (u_x - drag * relative), speed_y + 0.1 * (u_y - drag * speed_y)};
  }
};

/// Whether the boat is within 0.3 m of its goal during the last 2 of 8 s.
template <class Water>
bool holds(const Water& water, std::uint64_t seed) {
  slalom::Mppi controller{Boat<Water>{.water = water},
                          {.horizon = 20, .samples = 256, .temperature = 0.1, .variance = 1, .seed = seed}};
  const Boat<River> real{};
  Boat<River>::State<double> x{};
  double most = 0;
  for (int k = 0; k < 80; ++k) {
    x = real.step(x, controller.solve({x.x, x.y, x.speed_x, x.speed_y}, {.elapsed = real.dt}).inputs[0]);
    if (k >= 60) most = std::max(most, real.square_distance(x));
  }
  return most < 0.3 * 0.3;
}

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s examples/learned/boat.npz\n", argv[0]);
    return 2;
  }
  const slalom::Mlp<5, 2> network{slalom::load_mlp(argv[1])};
  const int without = succeeded([](auto seed) { return holds(NoWater{}, seed); });
  const int learned = succeeded([&](auto seed) { return holds(network, seed); });
  std::printf(
      "the boat holds its place: without a model of the water %d of 20 seeds, with the network %d of 20\n",
      without, learned);
  return learned >= 18 && learned > without ? 0 : 1;
} catch (const std::exception& error) {  // a file that cannot be read, or is damaged
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
