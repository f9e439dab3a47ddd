#pragma once

#include <cstdint>
#include <vector>

#include "slalom/core/network/mlp.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "slalom/maps/field.hpp"

namespace slalom::python {

/// The dynamics of a network and a cost of few parts.
struct NetworkModel {
  /// A disc in the plane of the first two states.
  struct Disc {
    double x = 0, y = 0, radius = 0;
  };
  slalom::detail::MlpNetwork network{1, 1};  ///< the state after a step, of state and inputs
  bool residual = false;                     ///< whether it gives the change of the state instead
  int states = 0, inputs = 0;                ///< together at most 64
  std::vector<double> goal, state_weights, terminal_weights;  ///< one for each state
  std::vector<double> input_weights;                          ///< one for each input
  std::vector<Disc> discs;
  double disc_weight = 0;                    ///< cost of a state that collides
  bool has_walls = false;                    ///< whether a state collides where `walls` is below `clearance`
  maps::Field walls;                         ///< distance from the nearest wall, m, at the first two states
  double clearance = 0;                      ///< m
  maps::Field field;                         ///< cost map, at the first two states
  bool has_field = false;                    ///< whether `field` has a part in the cost
  double field_weight = 1;                   ///< factor of `field` in the cost of a state
  double dt = 0;                             ///< s; 0: unknown
  std::vector<double> input_min, input_max;  ///< one value, one for each input, or none
};

/// Most values of a state and the inputs of a step.
constexpr int most = slalom::detail::MlpNetwork::max_neurons;

/// The parts of the cost of a state, and whether it collides.
template <class T>
struct StateCost {
  T distance = T(0), obstacles = T(0), field = T(0);
  mask_t<T> collided = mask_t<T>(false);
};

template <class T>
SLALOM_INLINE_CALLS StateCost<T> state_cost(const NetworkModel& m, const std::vector<double>& weights,
                                            const T* x) {
  StateCost<T> cost;
  for (std::size_t i = 0; i < weights.size(); ++i)
    cost.distance = cost.distance + T(weights[i]) * square(x[i] - T(m.goal[i]));
  for (const NetworkModel::Disc& disc : m.discs) {
    const auto inside = square(x[0] - T(disc.x)) + square(x[1] - T(disc.y)) < T(disc.radius * disc.radius);
    cost.collided = cost.collided || inside;
  }
  if (m.has_walls) cost.collided = cost.collided || m.walls.value(x[0], x[1]) < T(m.clearance);
  cost.obstacles = select(cost.collided, T(m.disc_weight), T(0));
  if (m.has_field) cost.field = T(m.field_weight) * m.field.value(x[0], x[1]);
  return cost;
}

template <class T>
SLALOM_INLINE_CALLS T input_cost(const NetworkModel& m, const T* u) {
  T cost(0);
  for (std::size_t i = 0; i < m.input_weights.size(); ++i) cost = cost + T(m.input_weights[i]) * square(u[i]);
  return cost;
}

/// Replaces a state by the one after a step.
template <class T>
SLALOM_INLINE_CALLS void take_step(const NetworkModel& m, const T* u, T* x) {
  T values[most], other[most];
  for (int i = 0; i < m.states; ++i) values[i] = x[i];
  for (int i = 0; i < m.inputs; ++i) values[m.states + i] = u[i];
  m.network.evaluate(values, other);
  for (int i = 0; i < m.states; ++i) x[i] = m.residual ? x[i] + values[i] : values[i];
}

/// Computes the rollouts of the samples `first` ... `first + count - 1` of a batch from the state `start`.
void roll_out_network(const NetworkModel& m, const float* start, const SequenceBatch& batch, int first,
                      int count, float* costs, std::uint8_t* collided) noexcept;

}  // namespace slalom::python
