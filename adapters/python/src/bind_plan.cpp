#include <algorithm>

#include "plan.hpp"

namespace slalom::python {
namespace {

template <class T>
py::array view(const Plan& plan, const T* data, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides = {}) {
  py::array array = strides.empty() ? py::array(py::dtype::of<T>(), shape, data, plan.owner)
                                    : py::array(py::dtype::of<T>(), shape, strides, data, plan.owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
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

template <class T>
py::array values(const Plan& plan, std::span<const T> list) {
  return view(plan, list.data(), {static_cast<py::ssize_t>(list.size())});
}

/// Per-sample values without their padding.
template <class T>
py::array per_sample(const Plan& plan, std::span<const T> list) {
  const SequenceBatch* samples = plan.result().samples;
  const std::size_t count = samples ? static_cast<std::size_t>(samples->samples()) : list.size();
  return values(plan, list.first(std::min(count, list.size())));
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
  py::dict all;
  all["draw"] = t.draw;
  all["evaluate"] = t.evaluate;
  all["guide"] = t.guide;
  all["update"] = t.update;
  all["total"] = t.total;
  return all;
}

/// Adds the results of the solver.
void bind_results(py::class_<Plan>& plan) {
  plan.def_property_readonly(
          "nominal", [](const Plan& p) { return sequence(p, p.result().nominal); },
          "float32 [horizon, inputs]; svg_mppi: the best guide")
      .def_property_readonly(
          "variances", [](const Plan& p) { return sequence(p, p.result().variances); },
          "float32 [horizon, inputs], variances of the distribution")
      .def_property_readonly(
          "samples", [](const Plan& p) { return samples(p); },
          "float32 [samples, horizon, inputs], the last samples")
      .def_property_readonly(
          "costs", [](const Plan& p) { return per_sample(p, p.result().costs); }, "float32 [samples]")
      .def_property_readonly(
          "weights", [](const Plan& p) { return per_sample(p, p.result().weights); },
          "float32 [samples]; they sum to 1")
      .def_property_readonly(
          "guides", [](const Plan& p) { return sequences(p, p.result().guides); },
          "float32 [guides, horizon, inputs], the final guides")
      .def_property_readonly(
          "guide_path", [](const Plan& p) { return sequences(p, p.result().guide_path); },
          "float32 [iterations x guides, horizon, inputs]")
      .def_property_readonly(
          "minimum_cost", [](const Plan& p) { return p.result().minimum_cost; },
          "the lowest cost of a sample")
      .def_property_readonly(
          "expected_cost", [](const Plan& p) { return p.result().expected_cost; },
          "weighted mean of the samples' costs")
      .def_property_readonly(
          "effective_sample_size", [](const Plan& p) { return p.result().effective_sample_size; },
          "1 / sum of squared weights")
      .def_property_readonly(
          "gradient_kinks", [](const Plan& p) { return p.result().gradient_kinks; },
          "exact gradients of guides in this solve that were taken at a kink, or were not finite")
      .def_property_readonly(
          "few_samples_solves", [](const Plan& p) { return p.result().few_samples_solves; },
          "solves in a row, with this one, whose effective sample size was below 3")
      .def_property_readonly(
          "has_few_samples", [](const Plan& p) { return p.result().has_few_samples(); },
          "whether there were 20 or more of them; a FewSamplesWarning says so once")
      .def_property_readonly(
          "collided_share", [](const Plan& p) { return p.result().collided_share; },
          "fraction of the samples that collide, 0 ... 1")
      .def_property_readonly(
          "iterations", [](const Plan& p) { return p.result().iterations; },
          "number of guide or distribution updates")
      .def_property_readonly(
          "times", [](const Plan& p) { return times(p); }, "wall-clock time (s) of each stage")
      .def_property_readonly(
          "mean", [](const Plan& p) { return sequence(p, p.result().mean); },
          "float32 [horizon, inputs], mean of the resulting distribution")
      .def_property_readonly(
          "temperature", [](const Plan& p) { return p.result().temperature; }, "the temperature in use");
}

py::dict to_numpy(const py::object& plan) {
  py::dict copies;
  for (const char* name : {"inputs", "states", "nominal", "variances", "samples", "costs", "weights",
                           "samples_collided", "guides"})
    copies[name] = plan.attr(name).attr("copy")();
  return copies;
}

}  // namespace

void bind_plan(py::module_& module) {
  py::class_<Plan> plan(
      module, "Plan",
      "The solution of a controller. Arrays are views of the controller's memory, valid until it solves "
      "again; `to_numpy` copies them.");
  bind_results(plan);
  plan.def_property_readonly(
          "status", [](const Plan& p) { return std::string(name(p.controller().status())); },
          "'ok', 'deadline', 'all_collided', 'degenerate' or 'non_finite_state'")
      .def_property_readonly(
          "ok", [](const Plan& p) { return p.controller().status() == Status::ok; },
          "whether the status is 'ok'")
      .def_property_readonly(
          "inputs",
          [](const Plan& p) {
            Controller& c = p.controller();
            return view(p, c.inputs().data(), {c.solver().horizon(), c.solver().inputs()});
          },
          "float64 [horizon, inputs]; the first row is for now")
      .def_property_readonly(
          "states",
          [](const Plan& p) {
            Controller& c = p.controller();
            return view(p, c.prediction().states.data(), {c.solver().horizon() + 1, c.problem().states()});
          },
          "float64 [horizon + 1, states], predicted for the inputs")
      .def_property_readonly(
          "cost", [](const Plan& p) { return p.controller().prediction().cost; }, "cost of the plan")
      .def_property_readonly(
          "collided", [](const Plan& p) { return p.controller().prediction().collided; },
          "whether the plan collides")
      .def_property_readonly(
          "cost_terms",
          [](const Plan& p) {
            py::dict all;
            for (const auto& [name, value] : p.controller().prediction().terms) all[py::str(name)] = value;
            return all;
          },
          "the parts of the plan's cost by name; they sum to it")
      .def_property_readonly(
          "corrections", [](const Plan& p) { return p.controller().corrections(); },
          "values that the final check changed: inputs that were not within the bounds, and a cost that was "
          "not "
          "finite once it has been read; 0 in normal operation")
      .def_property_readonly(
          "samples_collided", [](const Plan& p) { return per_sample(p, p.result().collided); },
          "uint8 [samples], 1 where a sample collides")
      .def_property_readonly(
          "controller", [](const Plan& p) { return p.owner; }, "the controller that made the plan")
      .def("to_numpy", &to_numpy,
           "Copies of all arrays by name, which stay valid: inputs, states, nominal, variances, samples, "
           "costs, weights, samples_collided, guides.");
}

}  // namespace slalom::python
