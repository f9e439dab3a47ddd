#pragma once

#include <memory>
#include <string>

#include "slalom/view/subject.hpp"

namespace slalom::tools {

/// Returns a problem with a method that solves it with its default options, and its drawing. Throws
/// std::invalid_argument, which lists the names, if there is none of that name.
std::unique_ptr<view::Subject> problem_subject(const std::string& name, const std::string& method,
                                               std::uint64_t seed);

}  // namespace slalom::tools
