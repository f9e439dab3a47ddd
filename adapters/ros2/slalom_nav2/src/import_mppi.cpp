// usage: import_mppi FILE
//
// Reads a parameter file of nav2 and writes its sections for nav2_mppi_controller::MPPIController as sections
// for slalom_nav2::Controller to standard output. Standard error has a line for each key. The exit status is
// 0, 1 if the file cannot be read or breaks a rule, 2 if the command line is wrong.
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "logic/mppi_import.hpp"

int main(int argc, char** argv) try {
  if (argc != 2 || argv[1][0] == '-') {
    std::fputs("usage: import_mppi FILE\n", stderr);
    return 2;
  }
  const slalom::nodes::MppiImport imported = slalom::nodes::import_mppi(argv[1]);
  std::fputs(imported.report.c_str(), stderr);
  if (std::fputs(imported.yaml.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
    throw std::runtime_error("standard output cannot be written");
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
