#pragma once

#include "slalom/view/subject.hpp"

/// The problems that `slalom view` shows beside a car.
namespace slalom::tools {

/// Returns a problem with a method that solves it with its default options, and its drawing. Throws
/// std::invalid_argument, which lists the names, if there is none of that name.
std::unique_ptr<view::SolverSubject> problem_subject(const std::string& name, const std::string& method,
                                                     std::uint64_t seed);

/// Returns a scenario of `slalom navigate` with its navigator: obstacles and goal can be dragged. Throws
/// std::invalid_argument, which lists the names, if there is no scenario or method of that name.
std::unique_ptr<view::SolverSubject> room_subject(const std::string& scenario, const std::string& method,
                                                  std::uint64_t seed);

}  // namespace slalom::tools
