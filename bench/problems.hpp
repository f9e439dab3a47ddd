#pragma once

#include <random>

#include "bench/problems.hpp"
#include "slalom/core/grid_view.hpp"
#include "slalom/core/math.hpp"
#include "slalom/core/network/mlp.hpp"
#include "slalom/core/problem.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/problems/quadrotor.hpp"

/// Problems of benchmarks, on the processor and on a GPU.
namespace slalom::bench {

/// Costs in cells of 0.1 m over 11 x 11 m with three discs, and a border of zeros for positions outside.
class CostMap {
 public:
  static constexpr double disc_cost = 250;

  CostMap() : cells_(static_cast<std::size_t>(rows + 2) << stride_log2) {
    constexpr double discs[][3] = {{8, 8, 0.4}, {4, 6, 0.5}, {6, 5, 0.3}};  // x, y, radius, m
    for (int row = 1; row <= rows; ++row) {
      for (int column = 1; column <= rows; ++column) {
        const double x = length - (row - 0.5) * resolution, y = length - (column - 0.5) * resolution;
        for (const double(&d)[3] : discs) {
          if (std::hypot(x - d[0], y - d[1]) < d[2])
            cells_[static_cast<std::size_t>((row << stride_log2) + column)] = static_cast<float>(disc_cost);
        }
      }
    }
  }
  GridView<1> view() const {
    return {cells_.data(), rows, rows, stride_log2, resolution, length / 2, length / 2};
  }

 private:
  static constexpr double length = 11, resolution = 0.1;  // m
  static constexpr int rows = 110, stride_log2 = 7;
  std::vector<float> cells_;
};

/// A differential drive that goes to a point of a cost map.
struct Navigation {
  template <class T>
  struct State {
    T x, y, yaw;  // m, m, rad
  };
  static constexpr int inputs = 2;  // speed, m/s; yaw rate, rad/s
  static constexpr const char* cost_names[] = {"goal_x", "goal_y", "goal_yaw", "discs"};
  double dt = 0.02;  // s
  double goal_x = 10, goal_y = 10, goal_yaw = 0;
  double weight_x = 5, weight_y = 5, weight_yaw = 20;
  GridView<1> map;

  template <class V>
  void visit_memory(V&& visit) const {
    visit(map);
  }
  template <class T>
  T look_up(const State<T>& s) const {
    return slalom::look_up(map, s.x, s.y);
  }
  template <class T>
  State<T> step(const State<T>& s, const T&, const Input<T, 2>& u) const {
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    const T travelled = u[0] * T(dt);
    return {s.x + travelled * cosine, s.y + travelled * sine, s.yaw + u[1] * T(dt)};
  }
  template <class T>
  CostTerms<T, 4> stage_cost(const State<T>& s, const T& disc, const Input<T, 2>&) const {
    return cost(s, disc);
  }
  template <class T>
  CostTerms<T, 4> terminal_cost(const State<T>& s, const T& disc) const {
    return cost(s, disc);
  }

 private:
  template <class T>
  CostTerms<T, 4> cost(const State<T>& s, const T& disc) const {
    return {{T(weight_x) * square(s.x - T(goal_x)), T(weight_y) * square(s.y - T(goal_y)),
             T(weight_yaw) * square(wrap_angle(s.yaw - T(goal_yaw))), disc},
            disc > T(0)};
  }
};

/// A car whose changes of speed, lateral speed and yaw rate are those of a network.
struct Learned {
  template <class T>
  struct State {
    T speed, lateral_speed, yaw_rate;
  };
  static constexpr int inputs = 2;
  static constexpr int unrolled_steps = 1;  // on a GPU, see docs/gpu.md
  Mlp<5, 3> network;

  template <class V>
  void visit_memory(V&& visit) const {
    visit(network);
  }
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 2>& u) const {
    const auto next = network(x.speed, x.lateral_speed, x.yaw_rate, u[0], u[1]);
    return {next[0], next[1], next[2]};
  }
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 2>&) const {
    return square(x.speed - T(1));
  }
};

/// A network with two hidden layers of 32 neurons and random weights, always the same.
inline Mlp<5, 3> random_network(Activation activation = Activation::tanh) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.2);
  MlpParameters p{.activation = activation, .residual = true};
  int entering = 5;
  for (const int neurons : {32, 32, 3}) {
    MlpParameters::Layer layer{entering, neurons, {}, {}};
    for (int i = 0; i < entering * neurons; ++i) layer.weights.push_back(normal(random));
    for (int i = 0; i < neurons; ++i) layer.biases.push_back(normal(random));
    p.layers.push_back(layer);
    entering = neurons;
  }
  return Mlp<5, 3>(p);
}

}  // namespace slalom::bench
