#pragma once

#include <mujoco/mujoco.h>

namespace slalom::mujoco {

/// The state of a MuJoCo model with as many positions (nq), velocities (nv) and activations (na): together
/// with the inputs it determines the next states.
template <int Positions, int Velocities, int Activations = 0>
struct State {
  static constexpr int size = Positions + Velocities + Activations;  ///< values beside the time

  double time = 0;           ///< s
  double values[size] = {};  ///< qpos, then qvel, then act, in the units of the model

  double* positions() noexcept { return values; }                                         ///< qpos [nq]
  const double* positions() const noexcept { return values; }                             ///< qpos [nq]
  double* velocities() noexcept { return values + Positions; }                            ///< qvel [nv]
  const double* velocities() const noexcept { return values + Positions; }                ///< qvel [nv]
  double* activations() noexcept { return values + Positions + Velocities; }              ///< act [na]
  const double* activations() const noexcept { return values + Positions + Velocities; }  ///< act [na]

  /// The state that a simulation of MuJoCo is in.
  static State of(const mjData& data) noexcept {
    State state;
    state.time = data.time;
    mju_copy(state.positions(), data.qpos, Positions);
    mju_copy(state.velocities(), data.qvel, Velocities);
    mju_copy(state.activations(), data.act, Activations);
    return state;
  }
};

}  // namespace slalom::mujoco
