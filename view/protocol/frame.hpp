#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slalom/evaluation/lap.hpp"

/// The message of a control step: everything that the page draws.
namespace slalom::view {

/// The names of the figures that each frame begins with, in their order.
const std::vector<std::string>& scalar_names();

/// Facts about a control step that ControlStep does not contain.
struct StepFacts {
  double deadline = 0;         ///< s that an update may take before the next is due
  double prediction_step = 0;  ///< s, of the plan
  int method = 0;              ///< index of the method that drove
};

/// Encodes control steps. Draws on the planner for what the candidates would have led to, outside the time
/// that the planner is measured by.
class FrameEncoder {
 public:
  /// `candidates`: at most so many of the samples are sent.
  explicit FrameEncoder(int candidates = 160) : max_candidates_(candidates) {}

  /// A control step without its bodies.
  std::string encode(const evaluation::ControlStep& tick, const StepFacts& facts);

 private:
  using States = std::span<vehicle::PredictedState>;
  States predict(const vehicle::Planner& planner, std::span<const float> inputs);
  void put_states(class FrameWriter& to, const vehicle::Planner& planner, std::span<const float> inputs);
  void put_scan(FrameWriter& to, const evaluation::ControlStep& tick) const;
  void put_cost_map(FrameWriter& to, const evaluation::ControlStep& tick) const;
  void put_candidates(FrameWriter& to, const evaluation::ControlStep& tick);
  void put_guides(FrameWriter& to, const evaluation::ControlStep& tick);
  void put_plan(FrameWriter& to, const evaluation::ControlStep& tick);
  static void put_others(FrameWriter& to, const evaluation::ControlStep& tick);

  int max_candidates_;
  std::vector<vehicle::PredictedState> states_;
  std::vector<float> sequence_;
  vehicle::PredictedCost cost_;
};

/// The bodies of a world as a block, to be appended to a frame; body 0 is the driven car.
std::string encode_bodies(const sim::World& world);
/// A second car on the same course, likewise.
std::string encode_ghost(const sim::World& world, std::span<const maps::Pose> plan);
/// The second controller, likewise: `frame` is its control step with its bodies, a message.
std::string encode_ghost_frame(std::string_view frame);
/// The course's map and line as a message of its own.
std::string encode_scene(const evaluation::Environment& environment);

/// From the driven car's body to the nearest wall or other body, m; negative inside.
double clearance_of(const sim::World& world);

}  // namespace slalom::view
