#pragma once

#include <string>

#include "view/session/session.hpp"

namespace slalom::tools {

/// Makes the live view show an evaluation: its laps and collisions, each of which can be repeated. Throws
/// IoError.
void open_evaluation(const std::string& folder, view::SessionOptions& options);

}  // namespace slalom::tools
