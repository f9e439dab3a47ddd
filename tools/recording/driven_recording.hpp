#pragma once

#include <fstream>

#include "slalom/evaluation/lap.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "tools/recording/ros_bag.hpp"
#include "tools/scenario/scenario.hpp"
#include "view/car/car_subject.hpp"
#include "view/recording/recorder.hpp"

/// Recordings that are read back: those of `slalom drive` (docs/recording.md), and bags of rosbag2 in MCAP or
/// sqlite3, as a file or the folder that it writes. All throw IoError with the file: also if it is not a
/// regular one (a pipe could block for ever) or larger than 4 GiB.
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

/// Reads the drive of a recording: what identifies a car, or also the scans.
DrivenRecording read_drive(const std::string& recording, Wanted wanted = Wanted::samples);

/// Reads the line of a recorded drive: its first lap if it comes back to its beginning, else all of it, open.
vehicle::GuideLine driven_line(const std::string& file);

}  // namespace slalom::tools
