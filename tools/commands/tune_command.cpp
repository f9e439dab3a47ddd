#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <system_error>

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
  std::vector<std::string> words{python, "-c", "from slalom import study; study.end_with('." + module + "')"};
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

/// Options as slalom.tuner reads them from the words of the process.
struct TuneArguments {
  std::string kind, course, config, scenario, tasks, methods = "svg_mppi", cluster, out;
  std::vector<std::string> vary, set;
  int obstacles = 5, rollouts = 64, seeds = 32, confirm = 0, jobs = 0, trials = 1000000;
  double minutes = 10;
  std::uint64_t seed = 0;
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
  command.option("KIND", a->kind, "car: laps; navigator: drives through rooms; suite: the problem suite")
      .required();
  command
      .option("--vary", a->vary,
              "key=LOW..HIGH or key=v1,v2,...: values of an option; by the logarithm where HIGH is ten times "
              "LOW or more")
      .repeatable()
      .required();
  command.option("--set", a->set, "key=value: an option that stays").repeatable();
  command.option("--minutes", a->minutes, "Time for trials", {0, 1e6});
  command.option("--trials", a->trials, "Most trials", {0, 1000000});
  command.option("--seeds", a->seeds, "Runs of a trial that is not pruned, in each place", {1, 100000});
  command.option("--confirm", a->confirm, "Runs on fresh seeds at the end; 0: as many as --seeds",
                 {0, 100000});
  command.option("--seed", a->seed, "First seed");
  command.option("--methods", a->methods, "Method");
  command.option("--course", a->course, "car: courses, separated by commas");
  command.option("--config", a->config, "car: the configuration from which it starts");
  command.option("--obstacles", a->obstacles, "car: number of parked cars", {1, 1000});
  command.option("--scenario", a->scenario, "car: oa, pt or both; navigator: rooms, separated by commas");
  command.option("--tasks", a->tasks, "suite: tasks, separated by commas");
  command.option("--rollouts", a->rollouts, "suite: rollouts in a solve", {1, 1000000});
  command.option("--jobs", a->jobs, "Runs in parallel; 0: one per processor core", {0, 1024});
  command.option("--cluster", a->cluster, "Address of a Dask scheduler whose workers drive");
  command.option("--out", a->out, "Folder of the trials and of best.yaml; the same call goes on there")
      .required();
  command.examples({"tune car --course eel --vary vehicle.usable_grip=0.7..0.95 --minutes 20 --out OUT",
                    "tune suite --tasks crane --vary batches=1..5 --vary noise_exponent=1.0..4.0 --out OUT"});
  command.action([a] { return tune(*a); });
}

}  // namespace slalom::tools
