#pragma once

#include <cstdint>
#include <memory>

#include "slalom/evaluation/lap.hpp"
#include "slalom/view/subject.hpp"

namespace slalom::view {

/// Returns a car on its course, which drives lap after lap. Throws what LapDrive throws.
std::unique_ptr<Subject> car_subject(const evaluation::LapSetup& setup, std::uint64_t seed);

}  // namespace slalom::view
