#include "tools/recording/recording.hpp"

#include "slalom/core/error.hpp"
#include "tools/recording/json_recording.hpp"
#include "tools/recording/mcap_recording.hpp"

namespace slalom::tools {

std::unique_ptr<Recording> make_recording(const std::string& file, const RecordingFacts& facts) {
  if (file.size() >= 5 && file.compare(file.size() - 5, 5, ".mcap") == 0)
    return std::make_unique<McapRecording>(file, facts);
  if (facts.times)
    throw CommandLineError("--record-times", "needs a recording in MCAP, whose name ends in .mcap");
  return std::make_unique<JsonRecording>(file, facts.settings);
}

}  // namespace slalom::tools
