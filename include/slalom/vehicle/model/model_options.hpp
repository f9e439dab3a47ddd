#pragma once

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// The options of a model that has none of its own.
struct NoOptions {
  bool operator==(const NoOptions&) const = default;
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, NoOptions>
void visit_options(Options&, Visit&&) {}

}  // namespace slalom::vehicle
