#pragma once

#include "keywords.hpp"
#include "problem.hpp"
#include "rollouts/network_model.hpp"

namespace slalom::python {

/// A problem of a `NetworkModel`. Its rollouts run in SIMD lanes, though sizes are known only at run time.
class NetworkProblem final : public AnyProblem, public BatchEvaluator {
 public:
  /// The model, and all that Python gave.
  struct Parts {
    py::object network;
    NetworkModel model;
    py::object walls = py::none(), field = py::none();  ///< a slalom.Field, or None
  };

  /// Throws std::invalid_argument with the rule that a part breaks.
  explicit NetworkProblem(Parts parts);

  std::unique_ptr<AnyProblem> clone() const override { return std::make_unique<NetworkProblem>(*this); }
  int states() const noexcept override { return parts_.model.states; }
  int inputs() const noexcept override { return parts_.model.inputs; }
  const BatchEvaluator& evaluator() const noexcept override { return *this; }
  double time_step() const noexcept override { return parts_.model.dt; }
  InputBounds stated_bounds() const override {
    return bounds_of(parts_.model.input_min, parts_.model.input_max, parts_.model.inputs);
  }
  void each_object(const std::function<void(void*)>& visit) override {
    for (py::object* object : {&parts_.network, &parts_.walls, &parts_.field}) visit(object);
  }
  void set_state(std::span<const double> state) noexcept override;
  std::vector<double> step(std::span<const double> state, std::span<const double> input, int k) override;
  Prediction predict(std::span<const double> state, std::span<const double> inputs) override;
  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override;

  const Parts& parts() const noexcept { return parts_; }
  /// Replaces the parts; throws as the constructor does.
  void set_parts(Parts parts) { *this = NetworkProblem(std::move(parts)); }

 private:
  Parts parts_;
  std::vector<float> state_;
};

}  // namespace slalom::python
