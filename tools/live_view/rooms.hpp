#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "slalom/view/subject.hpp"

namespace slalom::tools {

/// Returns a scenario of `slalom navigate` with its navigator, for the live view: obstacles and goal can be
/// dragged. Throws std::invalid_argument, which lists the names, if there is no scenario or method of that
/// name.
std::unique_ptr<view::Subject> room_subject(const std::string& scenario, const std::string& method,
                                            std::uint64_t seed);

}  // namespace slalom::tools
