#pragma once

#include <fstream>

#include "slalom/evaluation/lap.hpp"
#include "tools/scenario/scenario.hpp"
#include "view/car/car_subject.hpp"
#include "view/recording/recorder.hpp"

namespace slalom::tools {

struct RecordingFacts {
  const ScenarioArguments& arguments;
  const Scenario& scenario;
  const std::string& method;
  std::uint64_t seed = 0;
  double control_period = 0;               ///< s
  const nlohmann::ordered_json& settings;  ///< kept in the recording
  bool everything = false;                 ///< RecorderOptions::everything
  bool times = false;                      ///< with figures of the wall clock
};

/// A recording of laps in MCAP (docs/recording.md), as the live view records. The same settings and seed give
/// the same bytes.
class Recording {
 public:
  /// Begins the file. Throws IoError.
  Recording(const std::string& file, const RecordingFacts& facts);

  void begin_lap(std::uint64_t seed);
  void add(const evaluation::ControlStep& tick);
  void end_lap(const evaluation::LapResult& lap, int number);
  /// Ends the file. Throws IoError if anything could not be written.
  void close();

 private:
  void tell_state();

  std::string file_;
  std::shared_ptr<const view::SubjectFacts> facts_;
  double prediction_step_;  ///< s
  view::Choices choices_;
  view::DriveState state_;
  double control_period_;
  int ticks_ = 0;
  std::ofstream stream_;
  view::Recorder recorder_;
};

}  // namespace slalom::tools
