#include <algorithm>
#include <csetjmp>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>

#include "slalom/core/error.hpp"
#include "slalom/mujoco/evaluator.hpp"
#include "slalom/mujoco/model.hpp"
#include "slalom/mujoco/simulation.hpp"

namespace slalom::mujoco {
namespace {

/// The call to which an error of MuJoCo on this thread returns.
thread_local std::jmp_buf* failed_call = nullptr;

/// The handler that was installed before this one; null: MuJoCo's own behaviour.
void (*previous_handler)(const char*) = nullptr;

void handle_error(const char* message) {
  if (failed_call) std::longjmp(*failed_call, 1);
  if (previous_handler) return previous_handler(message);
  mju_user_error = nullptr;
  mju_error_s("%s", message);  // from 2.3 on, mju_error takes its first argument as a format
}

void install_handler() {
  static const bool installed = [] {
    previous_handler = mju_user_error;
    mju_user_error = handle_error;
    return true;
  }();
  static_cast<void>(installed);
}

/// Whether a call of MuJoCo returned without an error. MuJoCo is written in C: there are no destructors
/// between the error and this function.
template <class Call>
bool returns(Call call) noexcept {
  std::jmp_buf here;
  failed_call = &here;
  const bool returned = setjmp(here) == 0;
  if (returned) call();
  failed_call = nullptr;
  return returned;
}

/// MuJoCo reports a warning only if its count is 0, and sets the counts to 0 where it resets a simulation: a
/// count that differs from this one is a warning in this rollout.
constexpr int no_warning = 1 << 20;

void forget_warnings(mjData& data) {
  for (mjWarningStat& warning : data.warning) warning.number = no_warning;
}

}  // namespace

Model::Model(const std::filesystem::path& file) : file_(file.string()) {
  char message[1024] = "";
  mjModel* const model = mj_loadXML(file_.c_str(), nullptr, message, sizeof message);
  if (!model) throw IoError(file_, 0, message);
  model_ = std::shared_ptr<const mjModel>(model,
                                          [](const mjModel* m) { mj_deleteModel(const_cast<mjModel*>(m)); });
}

namespace detail {

void check_model(const Model& model, const Sizes& task) {
  const auto compare = [&](const char* what, int in_model, int in_task) {
    if (in_model != in_task) {
      throw std::invalid_argument(model.file() + ": has " + std::to_string(in_model) + ' ' + what +
                                  ", and the task " + std::to_string(in_task) + ": they must be equal");
    }
  };
  compare("positions (nq)", model->nq, task.positions);
  compare("velocities (nv)", model->nv, task.velocities);
  compare("activations (na)", model->na, task.activations);
  compare("inputs (nu)", model->nu, task.inputs);
  if (model->opt.integrator == mjINT_RK4)
    throw std::invalid_argument(model.file() + ": option integrator: RK4 must be Euler or implicit");
}

std::pair<double, double> input_range(const Model& model, int input) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (!model->actuator_ctrllimited[input]) return {-infinity, infinity};
  return {model->actuator_ctrlrange[2 * input], model->actuator_ctrlrange[2 * input + 1]};
}

}  // namespace detail

Simulation::Simulation(const Model& model) : model_(model) {
  install_handler();
  mjData* made = nullptr;
  if (!returns([&] { made = mj_makeData(&model_.get()); }) || !made) throw std::bad_alloc();
  data_.reset(made);
  forget_warnings(*data_);
}

Simulation::Simulation(const Simulation& other) : Simulation(other.model_) {
  mj_copyData(data_.get(), &model_.get(), other.data_.get());
}

void Simulation::restart(double time, const double* state) noexcept {
  const mjModel& m = model_.get();
  mjData& d = *data_;
  d.time = time;
  std::copy_n(state, m.nq, d.qpos);
  std::copy_n(state + m.nq, m.nv, d.qvel);
  std::copy_n(state + m.nq + m.nv, m.na, d.act);
  std::fill_n(d.qacc_warmstart, m.nv, 0.0);
  std::fill_n(d.ctrl, m.nu, 0.0);
  d.pstack = 0;  // an error leaves it where it was
  forget_warnings(d);
}

bool Simulation::observe() noexcept {
  return returns([this] { mj_step1(&model_.get(), data_.get()); }) && valid();
}

bool Simulation::advance() noexcept {
  return returns([this] { mj_step2(&model_.get(), data_.get()); }) && valid();
}

bool Simulation::valid() const noexcept {
  return std::all_of(std::begin(data_->warning), std::end(data_->warning),
                     [](const mjWarningStat& warning) { return warning.number == no_warning; });
}

}  // namespace slalom::mujoco
