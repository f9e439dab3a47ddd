#pragma once

#include "slalom/evaluation/lap.hpp"
#include "view/protocol/frame.hpp"
#include "view/protocol/messages.hpp"

/// A car on a course, as the live view drives and records it.
namespace slalom::view {

/// Returns a car on its course, which drives lap after lap. Throws what LapDrive throws.
std::unique_ptr<Subject> car_subject(const evaluation::LapSetup& setup, std::uint64_t seed);
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
