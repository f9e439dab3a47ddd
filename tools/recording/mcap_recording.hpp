#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "tools/recording/recording.hpp"
#include "view/protocol/frame.hpp"
#include "view/protocol/messages.hpp"
#include "view/recording/recorder.hpp"

namespace slalom::tools {

/// MCAP, as the live view records.
class McapRecording : public Recording {
 public:
  /// Throws IoError.
  McapRecording(const std::string& file, const RecordingFacts& facts);

  void begin_lap(int number, std::uint64_t seed) override;
  void add(const evaluation::ControlStep& tick) override;
  void end_lap(const evaluation::LapResult& lap, int number) override;
  void close() override;

 private:
  void tell_state();

  std::string file_, further_arguments_;
  std::shared_ptr<const evaluation::Environment> environment_;
  vehicle::Configuration configuration_;
  view::Choices choices_;
  view::DriveState state_;
  double control_period_;
  int ticks_ = 0;
  std::ofstream stream_;
  view::FrameEncoder encoder_;
  view::Recorder recorder_;
};

}  // namespace slalom::tools
