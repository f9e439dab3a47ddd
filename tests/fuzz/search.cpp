// What `slalom tune` takes: a range to search, the objective, and the plan that its folder holds.
#include <cmath>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "src/evaluation/json.hpp"
#include "tools/evaluation/tuning_job.hpp"

namespace slalom::fuzz {
namespace {

Json plan() {
  return {{"courses", Json::array({"wren"})},
          {"method", "mppi"},
          {"set", Json::array({"temperature=0.5:4:log"})},
          {"budget", 24},
          {"rungs", Json::array({{{"candidates", 4}, {"laps", 1}}})},
          {"seed0", 0}};
}

std::vector<std::string> seeds() {
  const std::string end(1, separator);
  return {"temperature=0.5:4:log" + end + "log_ms + 5*failures" + end + plan().dump(2),
          "svg_mppi.samples=16:4096" + end + "ms" + end + plan().dump(),
          "vehicle.body=box,discs" + end + "3*contacts+0.5lap_time" + end + "[]"};
}

/// Whether the range is valid: then each of its values is one that the option takes.
bool search(const std::string& text) {
  try {
    const vehicle::Configuration configuration;
    const auto dimension = evaluation::parse_dimension(text, configuration, "mppi");
    const double start = dimension.place(evaluation::option_text(configuration, dimension.key));
    require(start >= 0 && start <= 1, "the initial value has a place in the range");
    try {
      for (const auto& candidate : evaluation::design({dimension}, {start}, 0.5, 3, 8)) {
        vehicle::Configuration changed = configuration;
        for (const auto& [key, value] : candidate.set) vehicle::set_option(changed, key, value);
      }
    } catch (const std::invalid_argument& error) {
      require(false, std::string("an option takes every value of its range: ") + error.what());
    }
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

bool value(const std::string& objective) {
  evaluation::LapRow row;
  row.state_cost = 2;
  try {
    require(std::isfinite(evaluation::Objective(objective).of(row)), "an objective has a finite value");
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

bool resume(std::string_view stored) {
  try {
    tools::keep_plan(scratch_file("plan.json", stored), plan(), true);
  } catch (const IoError&) {
    return false;
  }
  const Json there = parse_json(stored), here = plan();
  for (const auto& [key, expected] : here.items())
    require(there.at(key) == expected, "a plan that is continued is that of the search");
  return true;
}

bool run(std::string_view bytes) {
  const auto [range, objective, stored] = split<3>(bytes);
  const bool searched = search(std::string(range)), valued = value(std::string(objective));
  return resume(stored) && searched && valued;
}

const Target target("search", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
