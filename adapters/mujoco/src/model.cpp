#include "slalom/mujoco/model.hpp"

#include <limits>
#include <stdexcept>
#include <string>

#include "slalom/core/error.hpp"
#include "slalom/mujoco/evaluator.hpp"

namespace slalom::mujoco {

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

}  // namespace slalom::mujoco
