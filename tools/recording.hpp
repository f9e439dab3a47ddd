#pragma once

#include <fstream>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "slalom/evaluation/lap_runner.hpp"

namespace slalom::tools {

/// Writes laps as JSON lines (docs/recording.md): settings, then for each lap its beginning, every control
/// step with what went in and what came out, and its end. The same settings and seed give the same bytes.
class Recording {
 public:
  /// Throws IoError.
  Recording(const std::string& file, const nlohmann::ordered_json& settings);

  void begin_lap(int number, std::uint64_t seed);
  void add(const evaluation::LapTick& tick);
  void end_lap(const nlohmann::ordered_json& result);

  /// Throws IoError if anything could not be written.
  void close();

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
