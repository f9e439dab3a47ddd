#pragma once

#include <functional>
#include <string>

#include "view/session/session.hpp"

namespace slalom::view {

/// What the files of a live drive contain.
struct DriveFileOptions {
  std::string program = "slalom";  ///< name of the program in recordings
  bool everything = false;         ///< RecorderOptions::everything
  bool times = false;              ///< with figures of the wall clock
};

/// Lets a session store its frames compressed, and send its drive as a recording or replay, which a thread
/// makes while the drive continues.
void add_files(SessionOptions& options, const DriveFileOptions& files);

}  // namespace slalom::view
