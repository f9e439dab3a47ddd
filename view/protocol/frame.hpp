#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/evaluation/lap.hpp"

/// The message of a control step contains everything that the page draws.
namespace slalom::view {

/// The names of the figures that each frame begins with, in their order.
const std::vector<std::string>& scalar_names();

/// Facts about a control step that ControlStep does not contain.
struct StepFacts {
  double deadline = 0;         ///< s that an update may take before the next is due
  double prediction_step = 0;  ///< s, of the plan
  int method = 0;              ///< index of the method that drove
};

/// Encodes control steps. The planner predicts where the candidates lead, outside of its measured time.
class FrameEncoder {
 public:
  /// Returns the message of a control step, without its bodies.
  std::string encode(const evaluation::ControlStep& tick, const StepFacts& facts);

 private:
  using States = std::span<vehicle::PredictedState>;
  States predict(const vehicle::Planner& planner, std::span<const float> inputs);
  void put_states(class FrameWriter& to, const vehicle::Planner& planner, std::span<const float> inputs);
  void put_candidates(FrameWriter& to, const evaluation::ControlStep& tick);
  void put_guides(FrameWriter& to, const evaluation::ControlStep& tick);
  void put_plan(FrameWriter& to, const evaluation::ControlStep& tick);
  void add_step_costs(States states);

  std::vector<vehicle::PredictedState> states_;
  std::vector<float> sequence_;
  std::vector<double> step_costs_;  ///< those of plan and candidates, [trajectory][point][term]
  vehicle::PredictedCost cost_;
};

/// Returns the block with the bodies of a world, to be appended to a frame. Body 0 is the driven car.
std::string encode_bodies(const sim::World& world);
/// Returns the block with the message `frame` of the ghost's control step, to be appended to a frame.
std::string encode_ghost_frame(std::string_view frame);
/// Returns the message with the map and the line of the course.
std::string encode_scene(const evaluation::Environment& environment);

/// Returns the distance from the driven car to the nearest wall or other body, m; negative if they overlap.
double clearance_of(const sim::World& world);

}  // namespace slalom::view
