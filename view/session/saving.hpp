#pragma once

#include <memory>
#include <string>
#include <vector>

#include "view/recording/recorder.hpp"

namespace slalom::view {

/// The messages of a file to be saved.
struct SavedDrive {
  std::string hello, options, state;
  std::shared_ptr<const std::string> course;
  std::vector<std::shared_ptr<const std::string>> frames;
};

/// Makes a file of a drive, as a message to the page: a page that plays it, or an MCAP recording.
std::string replay_message(const std::string& name, const SavedDrive& drive);
std::string recording_message(const std::string& name, const SavedDrive& drive, RecorderOptions options);

}  // namespace slalom::view
