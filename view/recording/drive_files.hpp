#pragma once

#include "view/recording/recorder.hpp"
#include "view/session/session.hpp"

namespace slalom::view {

/// Lets a session store its frames compressed, and send its drive as a recording or replay, which a thread
/// makes while the drive continues. `recorder`: without settings and scanner.
void add_files(SessionOptions& options, const RecorderOptions& recorder);

}  // namespace slalom::view
