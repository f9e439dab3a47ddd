// Solves the tasks of the suite in closed loop with several methods over temperatures, and writes one line of
// CSV for each task, method and temperature. script/problem-suite runs it and makes the table and the plot.

#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "slalom/core/option_access.hpp"
#include "task.hpp"

namespace slalom::suite {

constexpr const char* usage =
    "usage: slalom_problem_suite [--seeds 40] [--first-seed 0] [--tasks NAME,...]\n"
    "                            [--methods METHOD[:OPTION=VALUE]...,...] [--temperatures NUMBER,...]\n";

namespace {

/// Rollouts of a solve: as many for every method, those of guides included.
constexpr int rollouts = 1024;
constexpr int guides = 4, guide_iterations = 10, gradient_samples = 12;

SvgMppiOptions svg_mppi_options(const Task& task, double temperature) {
  SvgMppiOptions o = scaled_options(task);
  // A guide itself is evaluated in every iteration; all are before and after, with the last solution.
  o.samples = rollouts - guide_iterations * guides * (gradient_samples + 1) - (2 * guides + 1);
  o.temperature = o.guides.gradient_temperature = temperature;
  o.guides.count = guides;
  o.guides.iterations = guide_iterations;
  o.guides.gradient_samples = gradient_samples;
  return o;
}

/// The samples of an iteration, so that all iterations of a solve have as many rollouts as the other methods.
int samples_of_iteration(const SolverOptions& options) {
  const int* const iterations = options.find<int>("iterations");
  const double* const decay = options.find<double>("sample_decay");
  double batches = 1;
  for (int i = 1; iterations && i < *iterations; ++i) batches += std::pow(decay ? *decay : 1, -i);
  return static_cast<int>(rollouts / batches);
}

/// Options of a method, by the same rule for every task: those of docs/writing-a-problem.md, "Units".
SolverOptions method_options(const std::string& method, const Task& task, double temperature) {
  SolverOptions options = solver_options(method);
  if (method == SvgMppiOptions::method) {
    options = svg_mppi_options(task, temperature);
  } else {
    *options.find<int>("samples") = samples_of_iteration(options);
    *options.find<PerInput>("variance") = variance(task);
    if (double* const option = options.find<double>("temperature")) *option = temperature;
  }
  *options.find<int>("horizon") = task.horizon;
  *options.find<PerInput>("input_min") = per_input(task, &TaskInput::low);
  *options.find<PerInput>("input_max") = per_input(task, &TaskInput::high);
  return options;
}

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

/// Sets the options of "method:option=value:option=value".
void set_options(SolverOptions& options, const std::vector<std::string>& parts) {
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::vector<std::string> pair = split(parts[i], '=');
    if (pair.size() != 2 || !set_option(options, pair[0], pair[1]))
      throw std::invalid_argument("'" + parts[i] + "' must be OPTION=VALUE with an option of " + parts[0]);
  }
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Arguments {
  int seeds = 40;
  std::uint64_t first_seed = 0;
  std::vector<std::string> tasks;  ///< empty: all
  std::vector<std::string> methods{"mppi", "svg_mppi"};
  std::vector<std::string> temperatures{"0.01", "0.1", "1", "10", "100"};
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
    } else if (name == "--temperatures") {
      a.temperatures = split(value, ',');
    } else {
      throw std::invalid_argument("unknown argument '" + name + "'");
    }
  }
  return a;
}

/// The tasks of these names; all if there are none.
std::vector<Task> tasks_named(const std::vector<std::string>& names) {
  const std::vector<Task> all = all_tasks();
  if (names.empty()) return all;
  std::vector<Task> chosen;
  for (const std::string& name : names) {
    const auto task = std::find_if(all.begin(), all.end(), [&](const Task& t) { return t.name == name; });
    if (task == all.end()) throw std::invalid_argument("unknown task '" + name + "'");
    chosen.push_back(*task);
  }
  return chosen;
}

void run(const Arguments& a) {
  std::printf("task,several_ways,method,temperature,seeds,solved,effective_sample_size\n");
  for (const Task& task : tasks_named(a.tasks)) {
    for (const std::string& method : a.methods) {
      std::optional<Outcome> of_any_temperature;  // of a method without one
      for (const std::string& temperature : a.temperatures) {
        const std::vector<std::string> parts = split(method, ':');
        SolverOptions options = method_options(parts[0], task, std::stod(temperature));
        set_options(options, parts);
        const Outcome outcome =
            of_any_temperature ? *of_any_temperature : task.run({options, a.first_seed, a.seeds});
        if (!options.find<double>("temperature")) of_any_temperature = outcome;
        std::printf("%s,%d,%s,%s,%d,%d,%.4g\n", task.name.c_str(), task.ways == Ways::several, method.c_str(),
                    temperature.c_str(), a.seeds, outcome.solved, median(outcome.effective_sample_sizes));
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
