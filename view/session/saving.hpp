#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "view/recording/recorder.hpp"

namespace slalom::view {

/// The messages of a file to be saved.
struct SavedDrive {
  std::string hello, options, state;
  std::shared_ptr<const std::string> course;
  std::vector<std::shared_ptr<const std::string>> frames;
};

/// Makes files of the last minute in a thread of its own, while the drive continues.
class FileSaver {
 public:
  enum class Kind { recording, replay };
  /// Begins to make a file. `done` gets the file as a message to the page; `failed` gets the reason. Both are
  /// called from the thread. Throws if the previous file is not finished or the thread cannot be started.
  void save(Kind kind, const std::string& name, SavedDrive drive, RecorderOptions options,
            std::function<void(std::string)> done, std::function<void(std::string)> failed);

 private:
  std::atomic<bool> is_busy_{false};
  std::jthread thread_;
};

}  // namespace slalom::view
