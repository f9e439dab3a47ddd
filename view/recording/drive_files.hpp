#pragma once

#include "view/recording/recorder.hpp"
#include "view/session/session.hpp"

namespace slalom::view {

/// The page with a drive inside: with `everything` all that a drive has, else half of the frames, in short.
std::string replay_page(const StoredDrive& drive, bool everything);

/// Lets a session store its frames compressed, and send its drive as a recording or replay, which a thread
/// makes while the drive continues. `recorder`: without settings and scanner.
void add_files(SessionOptions& options, const RecorderOptions& recorder);

}  // namespace slalom::view
