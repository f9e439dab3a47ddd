#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "tools/commands/commands.hpp"

namespace slalom::tools {

void become_python(const std::string& module) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe"),
                              prefix = program.parent_path().parent_path();
  const char *const chosen = std::getenv("SLALOM_PYTHON"), *const others = std::getenv("PYTHONPATH");
  const std::string python = chosen                                        ? chosen
                             : std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3"
                                                                           : "python3";
  const std::string path = (prefix / "adapters/python:").string() +
                           (prefix / "lib/python3/dist-packages").string() +
                           (others ? ":" + std::string(others) : "");
  ::setenv("PYTHONPATH", path.c_str(), 1);
  ::setenv("SLALOM_PROGRAM", program.c_str(), 1);
  std::vector<std::string> words{python, "-c", R"(import sys
try: from slalom import study
except ImportError as e: sys.exit(f"slalom: {e}: {sys.executable} needs the package slalom; SLALOM_PYTHON names another")
study.end_with('.)" + module + "')"};
  std::ifstream line("/proc/self/cmdline", std::ios::binary);
  int index = 0;
  for (std::string word; std::getline(line, word, '\0');)
    if (++index > 2) words.push_back(word);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  ::execvp(python.c_str(), pointers.data());
  throw IoError(python, 0, "cannot be started: " + std::generic_category().message(errno));
}

namespace {

/// Options that slalom.tuner reads from the words of the process.
constexpr const char* words[][2] = {
    {"--methods", "Method; svg_mppi if not given"},
    {"--course", "car: courses, separated by commas"},
    {"--config", "car: the configuration from which it starts"},
    {"--scenario", "car: oa, pt or both; navigator: rooms, separated by commas"},
    {"--tasks", "suite: tasks, separated by commas"},
    {"--cluster", "Address of a Dask scheduler whose workers drive"}};
constexpr const char* numbers[][2] = {
    {"--minutes", "Time for trials; 10 if not given"},
    {"--trials", "Most trials"},
    {"--seeds", "Runs of a trial that is not pruned, in each place; 32 if not given"},
    {"--confirm", "Runs on fresh seeds at the end; as many as --seeds if not given"},
    {"--seed", "First seed"},
    {"--obstacles", "car: number of parked cars; 5 if not given"},
    {"--rollouts", "suite: rollouts in a solve; 64 if not given"},
    {"--jobs", "Runs in parallel; 0: one per processor core"}};

struct TuneArguments {
  std::string kind, out;
  std::vector<std::string> vary, set;
  std::string texts[std::size(words)];
  std::optional<double> values[std::size(numbers)];
};

int tune(const TuneArguments& a) {
  if (a.kind != "car" && a.kind != "navigator" && a.kind != "suite")
    throw CommandLineError("KIND", a.kind, "must be car, navigator or suite");
  for (const std::string& each : a.vary)
    if (each.find('=') == std::string::npos || each.find_first_of(".,", each.find('=')) == std::string::npos)
      throw CommandLineError("--vary", each, "must be key=LOW..HIGH or key=v1,v2,...");
  become_python("tuner");
}

}  // namespace

void declare_tune(Subcommand& command) {
  command.summary("Find values of options with which runs are better, by Optuna (docs/studies.md)");
  const auto a = std::make_shared<TuneArguments>();
  command.option("KIND", a->kind, "car: laps; navigator: drives through rooms; suite: the problem suite",
                 {.required = true});
  const char* const vary =
      "key=LOW..HIGH or key=v1,v2,...: values of an option; by the logarithm if HIGH is ten times LOW or "
      "more";
  command.option("--vary", a->vary, vary, {.required = true});
  command.option("--set", a->set, "key=value: an option that stays");
  for (std::size_t i = 0; i < std::size(words); ++i) command.option(words[i][0], a->texts[i], words[i][1]);
  for (std::size_t i = 0; i < std::size(numbers); ++i)
    command.option(numbers[i][0], a->values[i], numbers[i][1], {0, 1e9});
  command.option("--out", a->out, "Folder of trials and best.yaml; the same call goes on there",
                 {.required = true});
  command.examples({"tune car --course eel --vary vehicle.usable_grip=0.7..0.9 --out OUT",
                    "tune suite --tasks crane --vary batches=1..5 --out OUT"});
  command.action([a] { return tune(*a); });
}

}  // namespace slalom::tools
