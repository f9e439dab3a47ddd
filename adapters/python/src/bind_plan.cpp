#include <algorithm>

#include "controller.hpp"

namespace slalom::python {
namespace {

template <class T>
py::array view(const Plan& plan, const T* data, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides = {}) {
  py::array array = strides.empty() ? py::array(py::dtype::of<T>(), shape, data, plan.owner)
                                    : py::array(py::dtype::of<T>(), shape, strides, data, plan.owner);
  return read_only(array);
}

/// [step][input] values as an array (steps, inputs); empty if there are none.
py::array sequence(const Plan& plan, std::span<const float> values) {
  const py::ssize_t inputs = plan.controller().solver().inputs();
  return view(plan, values.data(), {static_cast<py::ssize_t>(values.size()) / inputs, inputs});
}

py::array sequences(const Plan& plan, const SequenceList& list) {
  const Solver& solver = plan.controller().solver();
  return view(plan, list.values.data(), {list.sequences, solver.horizon(), solver.inputs()});
}

/// Per-sample values without their padding.
template <class T>
py::array per_sample(const Plan& plan, std::span<const T> list) {
  const SequenceBatch* samples = plan.result().samples;
  const std::size_t count = samples ? static_cast<std::size_t>(samples->samples()) : list.size();
  return view(plan, list.data(), {static_cast<py::ssize_t>(std::min(count, list.size()))});
}

py::array samples(const Plan& plan) {
  const SequenceBatch* batch = plan.result().samples;
  if (!batch) return view<float>(plan, nullptr, {0, 0, 0});
  constexpr py::ssize_t width = sizeof(float);
  const py::ssize_t row = width * batch->stride();
  return view(plan, batch->row(0, 0), {batch->samples(), batch->steps(), batch->inputs()},
              {width, row * batch->inputs(), row});
}

py::dict times(const Plan& plan) {
  const StageTimes& t = plan.result().times;
  return py::dict("draw"_a = t.draw, "evaluate"_a = t.evaluate, "guide"_a = t.guide, "update"_a = t.update,
                  "total"_a = t.total);
}

py::dict to_numpy(const py::object& plan) {
  py::dict copies;
  for (const char* name : {"inputs", "states", "nominal", "variances", "samples", "costs", "weights",
                           "samples_collided", "guides"})
    copies[name] = plan.attr(name).attr("copy")();
  return copies;
}

py::dict cost_terms(const Plan& plan) {
  py::dict all;
  for (const auto& [name, value] : plan.controller().prediction().terms) all[py::str(name)] = value;
  return all;
}

/// Adds the results of the solver: numbers, and views of its memory.
void bind_results(py::class_<Plan>& plan) {
  const auto number = [&](const char* name, auto SolveResult::*field, const char* help) {
    plan.def_property_readonly(
        name, [field](const Plan& p) { return p.result().*field; }, help);
  };
  number("minimum_cost", &SolveResult::minimum_cost, "the lowest cost of a sample");
  number("expected_cost", &SolveResult::expected_cost, "weighted mean of the samples' costs");
  number("effective_sample_size", &SolveResult::effective_sample_size, "1 / sum of squared weights");
  number("collided_share", &SolveResult::collided_share, "fraction of the samples that collide, 0 ... 1");
  number("iterations", &SolveResult::iterations, "number of guide or distribution updates");
  number("rollouts", &SolveResult::rollouts,
         "number of control sequences evaluated, those of guides and choices included");
  number("temperature", &SolveResult::temperature, "the temperature in use");

  const auto array = [&](const char* name, auto make, auto SolveResult::*field, const char* help) {
    plan.def_property_readonly(
        name, [=](const Plan& p) { return make(p, p.result().*field); }, help);
  };
  array("nominal", sequence, &SolveResult::nominal, "float32 [horizon, inputs]; svg_mppi: the best guide");
  array("mean", sequence, &SolveResult::mean,
        "float32 [horizon, inputs], mean of the resulting distribution");
  array("variances", sequence, &SolveResult::variances,
        "float32 [horizon, inputs], variances of the distribution");
  array("costs", per_sample<float>, &SolveResult::costs, "float32 [samples]");
  array("weights", per_sample<float>, &SolveResult::weights, "float32 [samples]; they sum to 1");
  array("samples_collided", per_sample<std::uint8_t>, &SolveResult::collided,
        "uint8 [samples], 1 where a sample collides");
  array("guides", sequences, &SolveResult::guides, "float32 [guides, horizon, inputs], the final guides");
  array("guide_path", sequences, &SolveResult::guide_path, "float32 [iterations x guides, horizon, inputs]");
}

}  // namespace

void bind_plan(py::module_& module) {
  py::class_<Plan> plan(
      module, "Plan",
      "The solution of a controller. `inputs` and `states` are copies; the other arrays are views of the "
      "controller's memory, valid until it solves again, which `to_numpy` copies.",
      collected<Plan>());
  bind_results(plan);
  const auto read = reader(plan);
  read("samples", "float32 [samples, horizon, inputs], the last samples", &samples);
  read("symptom",
       "a likely reason for poor plans that stays for 20 solves, of which a SymptomWarning tells once: "
       "'none', 'few_samples', 'equal_costs', 'samples_diverge', 'small_variance', 'saturated_inputs', "
       "'noisy_plan' or 'no_progress'",
       [](const Plan& p) { return std::string(name(p.result().symptom())); });
  read("times", "wall-clock time (s) of each stage", &times);
  read("status",
       "'ok', 'deadline', 'all_collided', 'degenerate' or 'non_finite_state'; a time that is not valid is an "
       "error",
       [](const Plan& p) { return std::string(name(p.controller().checked_status())); });
  read("ok", "whether the status is 'ok'",
       [](const Plan& p) { return p.controller().checked_status() == Status::ok; });
  read("inputs", "float64 [horizon, inputs]; the first row is for now", [](const Plan& p) {
    Controller& c = p.controller();
    return Numbers({c.solver().horizon(), c.solver().inputs()}, c.inputs().data());
  });
  read("states", "float64 [horizon + 1, states], predicted for the inputs", [](const Plan& p) {
    Controller& c = p.controller();
    return Numbers({c.solver().horizon() + 1, c.problem().states()}, c.prediction().known_states().data());
  });
  read("cost", "cost of the plan", [](const Plan& p) { return p.controller().prediction().cost; });
  read("collided", "whether the plan collides",
       [](const Plan& p) { return p.controller().prediction().collided; });
  read("cost_terms", "the parts of the plan's cost by name; they sum to it", &cost_terms);
  read("corrections",
       "values that the checks changed: inputs that were not within the bounds, predicted states and costs "
       "that were not finite, and costs of samples that were nan; 0 in normal operation",
       [](const Plan& p) { return p.controller().corrections(); });
  read("controller", "the controller that made the plan", [](const Plan& p) { return p.owner; });
  plan.def("to_numpy", &to_numpy,
           "Copies of all arrays by name, which stay valid: inputs, states, nominal, variances, samples, "
           "costs, weights, samples_collided, guides.");
}

}  // namespace slalom::python
