// Solves the tasks of the suite in closed loop with several methods and numbers of rollouts, and writes one
// line of CSV for each task, method and number. script/problem-suite runs it and makes table and plot.

#include <cstdio>

#include "slalom/core/option_access.hpp"
#include "task.hpp"

namespace slalom::suite {

constexpr const char* usage =
    "usage: slalom_problem_suite [--seeds 40] [--first-seed 0] [--tasks NAME,...|holding] [--disturbed "
    "false]\n"
    "                            [--horizon 1]  factor of the horizon of each task\n"
    "                            [--methods METHOD[:OPTION=VALUE]...,...] [--rollouts NUMBER,...]\n";

namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == separator) {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

/// The default options of a method, with those of "method:option=value:option=value", and with samples for so
/// many rollouts in a solve, those of guides included.
SolverOptions method_options(const std::vector<std::string>& parts, const Task& task, int rollouts) {
  SolverOptions options = default_options(parts[0].c_str(), task);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::vector<std::string> pair = split(parts[i], '=');
    if (pair.size() != 2 || !set_option(options, pair[0], pair[1]))
      throw std::invalid_argument("'" + parts[i] + "' must be OPTION=VALUE with an option of " + parts[0]);
  }
  if (SvgMppiOptions* const svg = options.get_if<SvgMppiOptions>()) {
    const GuideOptions& guides = svg->guides;
    // In the closed form, a guide itself is evaluated in every iteration, and all are before and after, with
    // the last solution.
    const bool closed = svg->batches == 1;
    svg->samples = closed ? rollouts - guides.iterations * guides.count * (guides.gradient_samples + 1) -
                                (2 * guides.count + 2)
                          : rollouts;
    return options;
  }
  *options.find<int>("samples") = rollouts;
  return options;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Arguments {
  int seeds = 40;
  std::uint64_t first_seed = 0;
  std::vector<std::string> tasks;  ///< empty: all
  std::vector<std::string> methods{"mppi", "svg_mppi", "icem"};
  std::vector<std::string> rollouts{"64", "256", "1024"};
  bool disturbed = false;  ///< whether the plant differs from the model
  double horizon = 1;      ///< factor of the horizon of each task
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; i += 2) {
    const std::string name = argv[i];
    if (i + 1 == argc) throw std::invalid_argument(name + ": needs a value");
    const std::string value = argv[i + 1];
    if (name == "--seeds") {
      a.seeds = std::stoi(value);
    } else if (name == "--first-seed") {
      a.first_seed = std::stoull(value);
    } else if (name == "--tasks") {
      a.tasks = split(value, ',');
    } else if (name == "--methods") {
      a.methods = split(value, ',');
    } else if (name == "--rollouts") {
      a.rollouts = split(value, ',');
    } else if (name == "--disturbed" && (value == "true" || value == "false")) {
      a.disturbed = value == "true";
    } else if (name == "--horizon") {
      a.horizon = std::stod(value);
    } else {
      throw std::invalid_argument("unknown argument '" + name + "'");
    }
  }
  return a;
}

/// The tasks of these names; all if there are none, or those of exact holding.
std::vector<Task> tasks_named(const std::vector<std::string>& names) {
  if (names.empty()) return all_tasks();
  if (names == std::vector<std::string>{"holding"}) return holding_tasks();
  const std::vector<Task> all = all_tasks();
  std::vector<Task> chosen;
  for (const std::string& name : names) {
    const auto task = std::find_if(all.begin(), all.end(), [&](const Task& t) { return t.name == name; });
    if (task == all.end()) throw std::invalid_argument("unknown task '" + name + "'");
    chosen.push_back(*task);
  }
  return chosen;
}

void run(const Arguments& a) {
  std::printf("task,several_ways,method,rollouts,seeds,solved,median_cost\n");
  for (Task task : tasks_named(a.tasks)) {
    task.horizon = std::max(1, saturate_cast<int>(std::round(a.horizon * task.horizon)));
    for (const std::string& method : a.methods) {
      for (const std::string& rollouts : a.rollouts) {
        const std::vector<std::string> parts = split(method, ':');
        const SolverOptions options = method_options(parts, task, std::stoi(rollouts));
        const Outcome outcome =
            task.run({.options = options, .first = a.first_seed, .count = a.seeds, .disturbed = a.disturbed});
        std::printf("%s,%d,%s,%s,%d,%d,%.6g\n", task.name.c_str(), task.ways == Ways::several, method.c_str(),
                    rollouts.c_str(), a.seeds, outcome.solved, median(outcome.costs));
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace

}  // namespace slalom::suite

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "--help") {
    std::fputs(slalom::suite::usage, stdout);
    return 0;
  }
  try {
    slalom::suite::run(slalom::suite::parse(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slalom_problem_suite: %s\n", error.what());
    return 2;
  }
}
