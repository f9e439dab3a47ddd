#include "controller.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <exception>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/network/mlp.hpp"
#include "slalom/core/risk/risk_measure.hpp"
#include "slalom/maps/field.hpp"
#include "slalom/maps/ros_map.hpp"

namespace slalom::python {
namespace {

/// A problem in several variants of the world, as `RiskEvaluator` of C++. The variants are made once.
class RiskProblem final : public AnyProblem, public BatchEvaluator {
 public:
  using Variants = std::vector<std::unique_ptr<AnyProblem>>;

  /// The first variant is the problem itself.
  RiskProblem(Variants variants, py::object randomize, const RiskOptions& options)
      : variants_(std::move(variants)), randomize_(std::move(randomize)), options_(options) {}

  std::unique_ptr<AnyProblem> clone() const override {
    Variants copies;
    for (const auto& variant : variants_) copies.push_back(variant->clone());
    return std::make_unique<RiskProblem>(std::move(copies), randomize_, options_);
  }
  int states() const noexcept override { return problem().states(); }
  int inputs() const noexcept override { return problem().inputs(); }
  const BatchEvaluator& evaluator() const noexcept override { return *this; }
  double time_step() const noexcept override { return problem().evaluator().time_step(); }
  const Sampler* sampler() const noexcept override { return problem().evaluator().sampler(); }
  bool whole_batches() const noexcept override {
    return std::any_of(variants_.begin(), variants_.end(),
                       [](const auto& variant) { return variant->evaluator().whole_batches(); });
  }
  bool advance(std::span<double> state, std::span<const double> input, int k) const noexcept override {
    return problem().advance(state, input, k);
  }
  InputBounds stated_bounds() const override { return problem().stated_bounds(); }
  double unit_variance(int input) const noexcept override { return problem().unit_variance(input); }
  double input_step(int input) const noexcept override { return problem().input_step(input); }
  bool in_levels() const noexcept override { return problem().in_levels(); }
  void hold_rates(std::span<const double> previous, std::span<double> sequence) const noexcept override {
    problem().hold_rates(previous, sequence);
  }
  void carry(std::span<const float> wanted, std::span<const double> held,
             std::span<double> remainder) const noexcept override {
    problem().carry(wanted, held, remainder);
  }
  void set_state(std::span<const double> state) noexcept override {
    for (const auto& variant : variants_) variant->set_state(state);
  }
  void set_previous_input(std::span<const double> u) noexcept override {
    for (const auto& variant : variants_) variant->set_previous_input(u);
  }
  void begin(void* owner) override {
    for (const auto& variant : variants_) variant->begin(owner);
  }
  void finish() override {
    std::exception_ptr first;
    for (const auto& variant : variants_) {
      try {
        variant->finish();
      } catch (...) {
        if (!first) first = std::current_exception();
      }
    }
    if (first) std::rethrow_exception(first);
  }
  void each_object(const std::function<void(void*)>& visit) override {
    visit(&randomize_);
    for (const auto& variant : variants_) variant->each_object(visit);
  }
  std::vector<double> step(std::span<const double> state, std::span<const double> input, int k) override {
    return variants_.front()->step(state, input, k);
  }
  /// The states of the problem itself, and the cost as of `evaluate`.
  Prediction predict(std::span<const double> state, std::span<const double> inputs) override {
    Prediction result = variants_.front()->predict(state, inputs);
    VariantCosts costs;
    costs.values[0][0] = static_cast<float>(result.cost);
    for (std::size_t m = 1; m < variants_.size(); ++m) {
      const Prediction other = variants_[m]->predict(state, inputs);
      costs.values[m][0] = static_cast<float>(other.cost);
      result.collided = result.collided || other.collided;
    }
    float risk = 0;
    measure_risk(costs, 1, options_, &risk);
    result.cost = static_cast<double>(risk);
    result.terms = {{"total", result.cost}};
    return result;
  }

  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    // Callables take all samples of a batch at once, so the costs of all samples are kept for each variant.
    const auto samples = static_cast<std::size_t>(count);
    std::vector<float> all(variants_.size() * samples);
    std::vector<std::uint8_t> any(samples);
    for (std::size_t m = 0; m < variants_.size(); ++m) {
      variants_[m]->evaluator().evaluate(batch, first, count, costs, collided);
      std::copy_n(costs + first, count, &all[m * samples]);
      for (std::size_t i = 0; i < samples; ++i) any[i] |= collided[first + static_cast<int>(i)];
    }
    VariantCosts part;
    for (int done = 0; done < count; done += VariantCosts::capacity) {
      const int size = std::min(count - done, VariantCosts::capacity);
      for (std::size_t m = 0; m < variants_.size(); ++m)
        std::copy_n(&all[m * samples + static_cast<std::size_t>(done)], size, part.values[m]);
      measure_risk(part, size, options_, costs + first + done);
    }
    std::copy_n(any.data(), count, collided + first);
  }

  const AnyProblem& problem() const noexcept { return *variants_.front(); }
  /// The problem (0) or one of its variants.
  AnyProblem& variant(std::size_t index) const {
    if (index >= variants_.size())
      throw py::index_error("RiskEvaluator.variant: " + std::to_string(index) + " must be below " +
                            std::to_string(variants_.size()));
    return *variants_[index];
  }
  const py::object& randomize() const noexcept { return randomize_; }
  const RiskOptions& options() const noexcept { return options_; }

 private:
  Variants variants_;
  py::object randomize_;
  RiskOptions options_;
};

/// The problem and the variants that `randomize` makes; 2m and 2m + 1 of them from mirrored random numbers.
RiskProblem::Variants make_variants(const AnyProblem& problem, const py::object& randomize,
                                    const RiskOptions& options) {
  if (!PyCallable_Check(randomize.ptr()))
    throw std::invalid_argument("RiskEvaluator.randomize: must be callable");
  RiskProblem::Variants variants;
  variants.push_back(problem.clone());
  for (std::uint64_t m = 1; m < static_cast<std::uint64_t>(options.variants); ++m) {
    RandomStream random({options.seed, (m + 1) / 2}, m % 2 == 0);
    const py::object made = randomize(py::cast(&random, py::return_value_policy::copy));
    if (!py::isinstance<AnyProblem>(made))
      throw py::type_error("RiskEvaluator.randomize: returned " +
                           py::repr(py::type::of(made)).cast<std::string>() + ", must be a problem");
    const auto& variant = made.cast<const AnyProblem&>();
    if (variant.states() != problem.states() || variant.inputs() != problem.inputs())
      throw py::value_error("RiskEvaluator.randomize: returned a problem with " +
                            std::to_string(variant.states()) + " states and " +
                            std::to_string(variant.inputs()) + " inputs, must have " +
                            std::to_string(problem.states()) + " and " + std::to_string(problem.inputs()));
    variants.push_back(variant.clone());
  }
  return variants;
}

std::unique_ptr<RiskProblem> make_risk(const AnyProblem& problem, const py::object& randomize, int variants,
                                       const std::string& measure, double tail, double aversion,
                                       std::uint64_t seed) {
  RiskOptions options{variants, {}, tail, aversion, seed};
  set_from_keywords(options, py::kwargs(py::dict("risk_measure"_a = measure)), "RiskEvaluator");
  validate_options(options, "RiskEvaluator");
  return std::make_unique<RiskProblem>(make_variants(problem, randomize, options), randomize, options);
}

/// The parameter of a name. Throws AttributeError, with the names of all, if there is none.
Parameter parameter_of(CompiledProblem& problem, const std::string& name) {
  std::string names;
  for (const Parameter& each : problem.parameters()) {
    if (name == each.name) return each;
    names += (names.empty() ? "" : ", ") + std::string(each.name);
  }
  throw py::attribute_error("the problem has no parameter '" + name +
                            "'; it has: " + (names.empty() ? "none" : names));
}

/// The parameters of a network, from a slalom.mlp.Mlp.
MlpParameters parameters_of(const py::object& network, const std::string& name) {
  if (!py::hasattr(network, "layers") || !py::hasattr(network, "activation"))
    throw py::type_error(name + ": " + py::repr(network).cast<std::string>() +
                         " must be a slalom.mlp.Mlp or the file of one");
  const auto values = [](const py::object& array) {
    const Numbers numbers(array);
    return std::vector<double>(numbers.data(), numbers.data() + numbers.size());
  };
  MlpParameters p;
  for (const py::handle& layer : network.attr("layers")) {
    const auto [weights, biases] = layer.cast<std::pair<Numbers, Numbers>>();
    p.layers.push_back({static_cast<int>(weights.shape(1)), static_cast<int>(weights.shape(0)),
                        values(weights), values(biases)});
  }
  p.activation = activation_of(network.attr("activation").cast<std::string>());
  p.input_mean = values(network.attr("input_mean"));
  p.input_scale = values(network.attr("input_scale"));
  p.output_mean = values(network.attr("output_mean"));
  p.output_scale = values(network.attr("output_scale"));
  p.residual = network.attr("residual").cast<bool>();
  return p;
}

/// Sets numbers, a network (an Mlp or the file of one) or a field (a Field, or the map of which it is the
/// signed distance).
void set_attribute(CompiledProblem& problem, const std::string& name, const py::object& value) {
  const Parameter parameter = parameter_of(problem, name);
  if (parameter.kind == Parameter::Kind::numbers) {
    const auto values = value_as<Numbers>(value, name);
    checked({values.data(), values.data() + values.size()}, parameter.values.size(), name);
    std::copy_n(values.data(), values.size(), parameter.values.begin());
    return;
  }
  const bool is_file = py::hasattr(value, "__fspath__") || py::isinstance<py::str>(value);
  const auto file = is_file ? py::str(value).cast<std::string>() : "";
  if (parameter.kind == Parameter::Kind::network) {
    const MlpParameters network = is_file ? load_mlp(file) : parameters_of(value, name);
    parameter.set(&network);
  } else {
    const maps::Field field =
        is_file ? maps::signed_distance(maps::load_ros_map(file)) : value_as<maps::Field>(value, name);
    parameter.set(&field);
  }
  problem.given[name] = value;
}

/// The value of a parameter for Python: numbers, or what a network or a field was set to.
py::object attribute(CompiledProblem& problem, const Parameter& parameter) {
  if (parameter.kind == Parameter::Kind::numbers) return from_numbers(parameter.values);
  const auto found = problem.given.find(parameter.name);
  return found == problem.given.end() ? py::none() : std::any_cast<py::object>(found->second);
}

/// Loads the library of a compiled problem, which stays loaded. Throws ImportError if that fails.
std::unique_ptr<CompiledProblem> load(const std::string& file, const py::kwargs& keywords) {
  void* const loaded = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const make = loaded ? dlsym(loaded, "slalom_make_problem") : nullptr;
  if (!make) throw py::import_error(dlerror());
  std::unique_ptr<CompiledProblem> problem(reinterpret_cast<CompiledProblem* (*)()>(make)());
  problem->file = file;
  problem->object_of = [](std::any& object) -> void* { return std::any_cast<py::object>(&object); };
  for (const auto& [key, value] : keywords)
    set_attribute(*problem, key.cast<std::string>(), py::reinterpret_borrow<py::object>(value));
  return problem;
}

}  // namespace

void bind_risk(py::module_& module) {
  py::class_<RandomStream>(module, "RandomStream", "Random numbers of one variant of the world.", guarded())
      .def(
          "uniform", [](RandomStream& r, double low, double high) { return r.uniform(low, high); },
          "low"_a = 0.0, "high"_a = 1.0, "A uniform value.")
      .def("normal", &RandomStream::normal, "A standard normal value.");
  py::class_<RiskProblem, AnyProblem>(
      module, "RiskEvaluator",
      "A problem in several variants of the world: a controller of it finds inputs that are good in all of "
      "them. The variants are made once, so all samples of all solves meet the same ones. A sequence "
      "collides "
      "if it collides in any.",
      collected<RiskProblem>())
      .def(py::init(&make_risk), "problem"_a, "randomize"_a, py::kw_only(), "variants"_a = 9,
           "measure"_a = "mean", "tail"_a = RiskOptions{}.tail, "aversion"_a = RiskOptions{}.aversion,
           "seed"_a = RiskOptions{}.seed)
      .def_property_readonly(
          "problem", [](const RiskProblem& r) -> AnyProblem& { return r.variant(0); },
          py::return_value_policy::reference_internal, "the problem itself")
      .def("variant", &RiskProblem::variant, py::return_value_policy::reference_internal, "index"_a,
           "The problem (index 0) or one of its variants.")
      .def_property_readonly("randomize", &RiskProblem::randomize, "the callable")
      .def_property_readonly(
          "options",
          [](const RiskProblem& r) {
            const RiskOptions& o = r.options();
            return py::dict("variants"_a = o.variants,
                            "measure"_a = enum_names(o.measure)[static_cast<int>(o.measure)],
                            "tail"_a = o.tail, "aversion"_a = o.aversion, "seed"_a = o.seed);
          },
          "the options by name");
}

void bind_compiled(py::module_& module) {
  py::class_<CompiledProblem, AnyProblem>(
      module, "CompiledProblem",
      "A problem struct that `slalom.compile` has compiled. Its parameters are attributes.",
      collected<CompiledProblem>())
      .def(py::init(&load), "file"_a)
      .def_readonly("file", &CompiledProblem::file, "the file that it was loaded from")
      .def_property_readonly(
          "parameters",
          [](CompiledProblem& self) {
            py::dict all;
            for (const Parameter& parameter : self.parameters())
              all[parameter.name] = attribute(self, parameter);
            return all;
          },
          "the parameters by name")
      .def("__getattr__", [](CompiledProblem& self,
                             const std::string& name) { return attribute(self, parameter_of(self, name)); })
      .def("__setattr__",
           [](const py::object& self, const std::string& name, const py::object& value) {
             if (may_use(self.ptr(), py::str("parameters").ptr()))
               return set_attribute(self.cast<CompiledProblem&>(), name, value);
             throw py::error_already_set();
           })
      .def("__dir__", [](CompiledProblem& self) {
        py::list all = py::module_::import("builtins").attr("object").attr("__dir__")(py::cast(self));
        for (const Parameter& parameter : self.parameters()) all.append(parameter.name);
        return all;
      });

  module.def(
      "instruction_set", [] { return std::string(simd::name(simd::active_target())); },
      "The instruction set in use: avx512, avx2, sse4 or generic.");
}

}  // namespace slalom::python
