#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace slalom::testing {

/// The numbers of a comma-separated file, row by row; "nan" and "inf" are read too.
inline std::vector<std::vector<double>> read_csv_numbers(const std::filesystem::path& path,
                                                         bool skip_header) {
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error(path.string() + ": cannot be read");
  std::vector<std::vector<double>> rows;
  std::string line;
  if (skip_header) std::getline(stream, line);
  while (std::getline(stream, line)) {
    auto& row = rows.emplace_back();
    for (const char* text = line.c_str(); *text;) {
      char* end = nullptr;
      row.push_back(std::strtod(text, &end));
      if (end == text) throw std::runtime_error(path.string() + ": no number: " + line);
      text = *end == ',' ? end + 1 : end;
      while (*text == '\r' || *text == ' ') ++text;
    }
  }
  return rows;
}

}  // namespace slalom::testing
