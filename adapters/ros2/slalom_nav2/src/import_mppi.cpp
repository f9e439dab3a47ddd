// usage: import_mppi FILE [OUTPUT]
//
// Reads a parameter file of nav2 and writes its sections for nav2_mppi_controller::MPPIController as sections
// for slalom_nav2::Controller, to a file or to standard output. Standard error has a line for each key. The
// exit status is 0, 1 if the file cannot be read, breaks a rule or cannot be written, 2 if the command line
// is wrong.
#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>

#include "logic/mppi_import.hpp"

namespace {

using slalom::nodes::ImportedKey;
using slalom::nodes::ImportedSection;

std::string line_of(const std::string& file, const ImportedSection& section, const ImportedKey& key) {
  std::string text = file + ":" + std::to_string(key.line) + ": " + section.name + "." + key.key + ": " +
                     key.value + ": " + name(key.fate);
  if (!key.result.empty()) text += " to " + key.result;
  if (!key.why.empty()) text += " (" + key.why + ")";
  return text;
}

void run(const std::string& file, const std::string& output) {
  std::string yaml;
  for (const ImportedSection& section : slalom::nodes::import_mppi(file)) {
    yaml += section.yaml;
    for (const ImportedKey& key : section.keys)
      std::fprintf(stderr, "%s\n", line_of(file, section, key).c_str());
  }
  if (output.empty()) {
    if (std::fputs(yaml.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
      throw std::runtime_error("standard output cannot be written");
    return;
  }
  std::ofstream stream(output);
  stream << yaml;
  stream.close();
  if (!stream) throw std::runtime_error(output + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3 || argv[1][0] == '-') {
    std::fputs("usage: import_mppi FILE [OUTPUT]\n", stderr);
    return 2;
  }
  run(argv[1], argc > 2 ? argv[2] : "");
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
