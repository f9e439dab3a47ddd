#pragma once

#include <fstream>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tools/recording/recording.hpp"

namespace slalom::tools {

/// JSON lines: settings, then for each lap its start, the inputs and outputs of every control step, and its
/// end.
class JsonRecording : public Recording {
 public:
  /// Throws IoError.
  JsonRecording(const std::string& file, const nlohmann::ordered_json& settings);

  void begin_lap(int number, std::uint64_t seed) override;
  void add(const evaluation::ControlStep& tick) override;
  void end_lap(const evaluation::LapResult& lap, int number) override;
  void close() override;

 private:
  template <class Number>
  void number(Number value);
  template <class Values>
  void list(const char* key, const Values& values);
  void write();

  std::string file_;
  std::ofstream stream_;
  std::string line_;
};

}  // namespace slalom::tools
