#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slalom/evaluation/lap.hpp"
#include "view/protocol/frame.hpp"
#include "view/protocol/messages.hpp"

/// Frames and messages of a car on a course.
namespace slalom::view {

/// The car of a control step. Its states are x, y, yaw, speed and steering.
class CarSource : public virtual FrameSource {
 public:
  explicit CarSource(std::shared_ptr<const SubjectFacts> facts) : facts_(std::move(facts)) {}

  /// Takes a control step, which the functions below tell of. `prediction_step`: s of a step of the plan.
  void observe(const evaluation::ControlStep& step, double prediction_step);
  /// Returns the planner's result, with the inputs that it chose.
  SolveResult solve() const;

  const SubjectFacts& facts() const override { return *facts_; }
  int status(const SolveResult&) const override;
  std::span<const double> inputs() const override { return inputs_; }
  std::size_t inputs_per_step() const override;
  Trajectories roll_out(std::span<const double>, std::span<const float> sequences) override;
  std::vector<maps::Pose> poses(std::span<const double> states) override;
  std::vector<Shape> shapes() override;
  std::vector<Line> figure(std::span<const double>) override { return {}; }
  std::vector<double> figures() override;
  std::string blocks() override;
  std::optional<StepMeasures> measures() const override;

 private:
  std::shared_ptr<const SubjectFacts> facts_;
  const evaluation::ControlStep* step_ = nullptr;
  double prediction_step_ = 0;  ///< s
  std::vector<double> inputs_;
};

/// Returns the bodies of a world, but the first car; their indices are the numbers of the bodies less 1.
std::vector<Shape> shapes_of(const sim::World& world);
/// Returns the states of the first car of a world.
std::vector<double> state_of(const sim::World& world);
/// Returns the facts of a car, without the map and line of the course unless there is one.
std::shared_ptr<const SubjectFacts> car_facts(const evaluation::Environment* environment = nullptr);
/// The names of the figures of a car's frame, in their order.
const std::vector<std::string>& car_scalars();
/// Completes the names of a scenario by what its course tells.
ScenarioNames with_course(ScenarioNames names, const evaluation::Environment& environment);
/// Returns all options of a configuration by section, those of `method` first.
std::vector<OptionSection> sections_of(const vehicle::Configuration& configuration,
                                       const std::string& method);
/// Encodes the control step of a car. Its planner predicts where the candidates lead, outside of its measured
/// time. `period`: s of a control step; `prediction_step`: s of a step of the plan; `method`: its index.
std::string encode_car(std::shared_ptr<const SubjectFacts> facts, const evaluation::ControlStep& step,
                       double period, double prediction_step, int method);

}  // namespace slalom::view
