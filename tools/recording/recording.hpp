#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "slalom/evaluation/lap.hpp"
#include "tools/scenario/scenario.hpp"

namespace slalom::tools {

/// A recording of laps. The same settings and seed give the same bytes.
class Recording {
 public:
  virtual ~Recording() = default;
  virtual void begin_lap(int number, std::uint64_t seed) = 0;
  virtual void add(const evaluation::ControlStep& tick) = 0;
  virtual void end_lap(const evaluation::LapResult& lap, int number) = 0;
  /// Throws IoError if anything could not be written.
  virtual void close() = 0;
};

struct RecordingFacts {
  const ScenarioArguments& arguments;
  const Scenario& scenario;
  const std::string& method;
  std::uint64_t seed = 0;
  double control_period = 0;               ///< s
  const nlohmann::ordered_json& settings;  ///< kept in the recording
  bool everything = false;                 ///< RecorderOptions::everything, MCAP only
  bool times = false;                      ///< with figures of the wall clock, MCAP only
};

/// Begins a recording: in MCAP if the file's name ends in .mcap, otherwise in JSON lines (docs/recording.md).
/// Throws IoError.
std::unique_ptr<Recording> make_recording(const std::string& file, const RecordingFacts& facts);

}  // namespace slalom::tools
