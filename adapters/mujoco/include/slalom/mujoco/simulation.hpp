#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <utility>

#include "slalom/mujoco/model.hpp"

namespace slalom::mujoco {

/// A simulation of a model whose failures are return values. By itself MuJoCo writes a log file and resets
/// the simulation if a state diverges, and ends the program if its stack is too small.
class Simulation {
 public:
  /// Allocates all that the simulation needs. Throws std::bad_alloc. From the first one on, MuJoCo's handler
  /// of errors (`mju_user_error`) is one that returns to the call that failed; an error outside such a call
  /// reaches the handler before it.
  explicit Simulation(const Model& model);
  /// Makes a simulation in the same state. Throws std::bad_alloc.
  Simulation(const Simulation& other);
  Simulation(Simulation&&) noexcept = default;
  /// Copies or moves.
  Simulation& operator=(Simulation other) noexcept {
    model_ = std::move(other.model_);
    data_ = std::move(other.data_);
    return *this;
  }

  /// The simulation as MuJoCo has it.
  const mjData& data() const noexcept { return *data_; }
  /// The inputs of the next step [nu].
  double* inputs() noexcept { return data_->ctrl; }

  /// Continues from a time (s) and a state [nq + nv + na], without inputs, applied forces and a warm start,
  /// so that what follows depends on nothing else.
  void restart(double time, const double* state) noexcept;

  /// Computes what depends on positions and velocities, with their sensors (mj_step1). Whether it is valid.
  bool observe() noexcept;
  /// After `observe`: applies the inputs for a time step of the model (mj_step2). Whether the simulation is
  /// valid: no value diverged, and contacts and constraints fit into the memory that the model has for them.
  bool advance() noexcept;

 private:
  bool valid() const noexcept;

  struct Delete {
    void operator()(mjData* data) const noexcept { mj_deleteData(data); }
  };
  Model model_;
  std::unique_ptr<mjData, Delete> data_;
};

}  // namespace slalom::mujoco
